# make demo: build, compress and restore the samples.  make test: everything that CI checks.
PYTHON ?= python3
CXX ?= g++
VENV := .venv
BIN := $(VENV)/bin
CORPUS_SOURCE := ../shared/data
SANITIZE := -std=c++20 -O1 -g -ffp-contract=off -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all -Icore -Iinclude \
    -DFUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
FUZZ_RUNS ?= 5000
JOBS := $(shell getconf _NPROCESSORS_ONLN)
sources := $(wildcard core/*/*.cpp core/*/*.hpp)
headers := $(filter %.hpp,$(sources)) $(wildcard core/*/data/*)
kernels := $(filter-out core/python/% core/wasm/% core/check/% core/fuzz/% core/player/%,$(filter %.cpp,$(sources)))

.PHONY: demo demo-runs test long check stub tests test-js browser node player npm compilers wasm sanitize fuzz bench wheel clean

demo: $(VENV)/.installed
	@PYTHONPATH=benchmarks $(BIN)/python -m mocapress_bench demo

test: check sanitize test-js demo-runs tests

# The demo, seen only where it fails.
demo-runs: $(VENV)/.installed
	@mkdir -p build
	@$(MAKE) --no-print-directory demo >build/demo.log 2>&1 || { cat build/demo.log; exit 1; }

# What takes too long for every test run: builds that are much like others; 1,000 kills at random moments, then one before every call;
# 10,000 mutants of each codec and format; texts that tell several lies; a table of 10 GB.
long: $(VENV)/.built $(VENV)/.zig corpus compilers
	MOCAPRESS_LONG=1 $(BIN)/pytest tests/core
	$(BIN)/python tests/campaigns/kills.py --runs 1000 \
	    $(if $(wildcard corpus/.version),--corpus corpus) --every-call
	$(BIN)/python tests/campaigns/library_kills.py --runs 300
	$(BIN)/python tests/campaigns/mutants.py --runs 10000
	$(BIN)/python tests/campaigns/lies.py --runs 20000
	$(BIN)/python tests/campaigns/large_inputs.py
	$(MAKE) sanitize FUZZ_RUNS=1000000

check: $(VENV)/.built
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	@$(BIN)/clang-format --dry-run --Werror $(sources)
	@echo $(filter-out core/python/% core/wasm/%,$(filter %.cpp,$(sources))) | xargs -n 4 -P 2 sh -c \
	    '$(BIN)/clang-tidy --quiet "$$@" -- -std=c++20 -Icore -Iinclude 2>/dev/null' clang-tidy
	@$(STUB) build/_core.pyi && cmp build/_core.pyi src/mocapress/_core.pyi || { \
	    echo "the bindings have changed: make stub writes src/mocapress/_core.pyi"; exit 1; }
	$(BIN)/mypy

# What Python's type checkers are told of the compiled module, by the module itself.
STUB := $(BIN)/python -m nanobind.stubgen -q -m mocapress._core -o
stub: $(VENV)/.built
	$(STUB) src/mocapress/_core.pyi

tests: $(VENV)/.built $(if $(CI),$(VENV)/.zig) corpus browser node player npm compilers
	MOCAPRESS_CORPUS=$(if $(wildcard corpus/.version),$(CURDIR)/corpus,$(MOCAPRESS_CORPUS)) \
	    $(BIN)/pytest -n auto --dist worksteal --durations 20

# The decoders under AddressSanitizer and UBSan, on seeds and mutations of them; what a run prints
# repeats it: make sanitize FUZZ_SEED=N.
fuzz_targets := $(filter-out core/fuzz/driver.cpp,$(wildcard core/fuzz/*.cpp))
fuzzers := $(patsubst core/fuzz/%.cpp,build/fuzz/%,$(fuzz_targets))

sanitize: $(VENV)/.built
	@$(MAKE) --no-print-directory -j $(JOBS) $(fuzzers)
	@$(MAKE) --no-print-directory -j $(JOBS) --output-sync=target fuzz

fuzz: $(fuzzers:%=%.fuzzed) build/fuzz/container.fuzzed

build/fuzz/container.fuzzed:
	$(BIN)/python core/fuzz/container.py -runs=$$(($(FUZZ_RUNS) / 10)) $(FUZZ_SEED:%=-seed=%)

build/fuzz/%.fuzzed: build/fuzz/%
	$< $(wildcard core/fuzz/seeds/$*/*) -runs=$(FUZZ_RUNS) $(FUZZ_SEED:%=-seed=%)

$(fuzzers): build/fuzz/%: build/fuzz/core/fuzz/%.o build/fuzz/core/fuzz/driver.o $(kernels:%.cpp=build/fuzz/%.o)
	@$(CXX) $(SANITIZE) $(filter %.o,$^) $(LIBRARIES) -o $@

# That of libmocapress has the reader of files beside the kernels.
build/fuzz/player: LIBRARIES := -llzma -lz
build/fuzz/player: $(patsubst %.cpp,build/fuzz/%.o,$(wildcard core/player/*.cpp)) build/fuzz/dictionary.o

build/fuzz/dictionary.o: src/mocapress/container/dictionary1.bin core/player/dictionary.cpp.in
	@mkdir -p $(@D)
	@sed "s/@DICTIONARY@/$$(od -An -v -tu1 $< | tr -s ' \n' ',' | sed 's/^,//')/" core/player/dictionary.cpp.in \
	    >build/fuzz/dictionary.cpp
	@$(CXX) $(SANITIZE) -c build/fuzz/dictionary.cpp -o $@

build/fuzz/%.o: %.cpp $(headers)
	@mkdir -p $(@D)
	@$(CXX) $(SANITIZE) -Wno-psabi -c $< -o $@

test-js: browser
	@if command -v node >/dev/null; then node --test tests/viewer/*.test.mjs; \
	    else test -z "$$CI"; fi

# What the page's tests run in, and the shells in which completion is tried. Where it is not there
# and cannot be installed, the tests are skipped and say so; in CI those of the page fail.
browser:
	@{ command -v node && command -v chromium && command -v zsh && command -v fish; } >/dev/null || { \
	    if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	        apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install -y \
	            --no-install-recommends nodejs chromium fonts-dejavu-core zsh fish >/dev/null; \
	    else false; fi; } || echo "not all there (Debian: apt-get install nodejs chromium zsh fish)"

# Packages of npm that tests take: Khronos's validator of glTF, and three.js with its reader of it.
node: browser
	@cmp -s tests/node/package-lock.json build/node/package-lock.json || { \
	    mkdir -p build/node && cp tests/node/*.json build/node && \
	    npm ci --silent --no-audit --no-fund --prefix build/node; } || { \
	    rm -f build/node/package-lock.json; echo "no packages of npm: tests of glTF in viewers are skipped"; }

# libmocapress, of the kernels that the Python module was built of, and the program that tests try
# it with.
player: $(VENV)/.installed
	@{ command -v cmake && printf '#include <lzma.h>\n#include <zlib.h>\n' | $(CXX) -E -xc++ -; } >/dev/null 2>&1 || { \
	    if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	        apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install -y \
	            --no-install-recommends cmake zlib1g-dev liblzma-dev >/dev/null; \
	    else false; fi; } || echo "no cmake, zlib or lzma: tests of libmocapress are skipped"
	@mkdir -p build/player && { cmake -S . -B build/player/library -DCMAKE_CXX_COMPILER=$(CXX) \
	        -DMOCAPRESS_CORE=$(CURDIR)/$$(ls build/*/libmocapress_core.a | head -1) \
	        -DCMAKE_INSTALL_PREFIX=$(CURDIR)/build/player/prefix && \
	    cmake --build build/player/library --target install && \
	    cmake -S tests/player -B build/player -DCMAKE_PREFIX_PATH=$(CURDIR)/build/player/prefix && \
	    cmake --build build/player; } >build/player/log 2>&1 || { test -z "$$CI" || cat build/player/log; }

# What builds the core in other ways and runs it there (tests/core/test_determinism.py). What is
# missing and cannot be installed is skipped by the tests, which say so.
compilers := clang++ aarch64-linux-gnu-g++ qemu-aarch64 x86_64-w64-mingw32-g++-posix wine
compilers:
	@command -v $(compilers) | wc -l | grep -qx $(words $(compilers)) || { \
	    if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null && [ "$$(uname -m)" = x86_64 ]; then \
	        apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install -y \
	            --no-install-recommends clang g++-aarch64-linux-gnu qemu-user \
	            g++-mingw-w64-x86-64-posix wine wine64 >/dev/null; \
	    else false; fi; } || echo "not all other compilers are there: $(compilers)"

# The package for npm, of parts of the page: build/npm is what would be published.
npm_wasm := exact near patterns qssd kinematics
npm:
	@rm -rf build/npm && mkdir -p build/npm/mcz build/npm/files/wasm build/npm/files/vendor/xz
	@cp -r npm/* LICENSE build/npm && cp viewer/mcz/*.js build/npm/mcz
	@cp $(npm_wasm:%=viewer/wasm/%.wasm) build/npm/files/wasm
	@cp viewer/vendor/xz/* build/npm/files/vendor/xz && cp src/mocapress/container/dictionary1.bin build/npm/files

# The core for the page, in modules of which it carries those that it needs; viewer/wasm/ keeps what
# this builds.
decoders := app diffma exact mrpa near patterns qssd
wasm_modules := $(patsubst %,build/wasm/%.wasm,$(decoders) formats kinematics)
ZIG := $(BIN)/python -m ziglang c++ -target wasm32-wasi -std=c++20 -ffp-contract=off -fno-math-errno -fno-exceptions \
    -fno-rtti -msimd128 -flto -Wall -Wextra -Icore -Wl,--strip-all

wasm: $(wasm_modules)
	install -m 644 $^ viewer/wasm/

# The sources of a module; modules and the check of WebAssembly share objects.
wasm_sources = core/wasm/space.cpp core/wasm/$*.cpp $(if $(filter $*,$(decoders)),core/wasm/decoder.cpp) \
    $(wildcard $(patsubst %,core/%/*.cpp,$(if $(filter kinematics,$*),motion,$*) $*_fast $(if $(filter mrpa,$*),app) coding numbers))

.PRECIOUS: build/wasm/%.o
build/wasm/%.o: %.cpp $(headers) | $(VENV)/.zig
	@mkdir -p $(@D)
	$(ZIG) -Os -c $< -o $@.$$$$ && mv $@.$$$$ $@

# The compiler for WebAssembly has 0.4 GB; no user needs it, and developers only for `make wasm`. One
# version, so that every machine builds the same bytes.
$(VENV)/.zig:
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check ziglang==0.17.1
	@touch $@

# A codec's kernels built in other ways, build/check/WAY/CODEC: each must print what
# tests/golden/kernels_CODEC.txt says. MOCAPRESS_NO_CLONES turns run-time dispatch off, so that a
# way is what its flags say; the package has it, and emulated processors choose.
EXACT := -std=c++20 -ffp-contract=off -fno-math-errno -fno-trapping-math -Wno-psabi -Wall -Wextra -Icore
ONE := -DMOCAPRESS_NO_CLONES
check_o0 := $(CXX) -O0 $(EXACT) $(ONE)
check_baseline := $(CXX) -O3 -march=x86-64 $(EXACT) $(ONE)
check_avx2 := $(CXX) -O3 -mavx2 -mfma $(EXACT) $(ONE)
check_avx512 := $(CXX) -O3 -march=x86-64-v4 $(EXACT) $(ONE)
check_clang := clang++ -O3 -mavx2 -mfma $(EXACT) $(ONE)
check_clang_o0 := clang++ -O0 $(EXACT) $(ONE)
check_aarch64 := aarch64-linux-gnu-g++ -O3 -static $(EXACT) $(ONE)
check_windows := x86_64-w64-mingw32-g++-posix -O3 -static $(EXACT) $(ONE)
# Not allowed; that it prints something else shows that the check sees it.
check_contracted := $(CXX) -O2 -mavx2 -mfma $(EXACT) $(ONE) -ffp-contract=fast

# Objects, build/check/WAY/core/..., serve all codecs of a way.
.SECONDEXPANSION:
$(wasm_modules): build/wasm/%.wasm: $$(addprefix build/wasm/,$$(addsuffix .o,$$(basename $$(wasm_sources))))
	$(ZIG) -Os -mexec-model=reactor $^ -o $@

check_codec = $(basename $(*F))
check_sources = core/check/$(check_codec).cpp core/coding/record.cpp core/motion/kinematics.cpp \
    core/numbers/line.cpp core/numbers/powers.cpp core/numbers/text.cpp \
    $(wildcard core/$(check_codec)/*.cpp core/$(check_codec)_*/*.cpp \
    $(if $(filter mrpa,$(check_codec)),core/app/*.cpp))
check_way = $(firstword $(subst /, ,$*))

.PRECIOUS: build/check/%.o
build/check/%.o: $(wildcard core/check/*) $(kernels) $(headers)
	@mkdir -p $(@D)
	$(check_$(check_way)) -c $(*:$(check_way)/%=%).cpp -o $@

build/check/%: $$(addprefix build/check/$$(*D)/,$$(addsuffix .o,$$(basename $$(check_sources))))
	$(check_$(*D)) $^ -o $@

# Of the library that the package has.
build/check/usual/%: core/check/%.cpp $(wildcard core/check/*) $(VENV)/.installed
	@mkdir -p $(@D)
	$(CXX) -O3 $(EXACT) $< $$(ls build/*/libmocapress_core.a | head -1) -o $@

# Of the objects that modules are made of, run by Node.
build/check/wasm/%: $$(addprefix build/wasm/,$$(addsuffix .o,$$(basename $$(check_sources))))
	@mkdir -p $(@D)
	$(ZIG) -Os $^ -o $@

bench: $(VENV)/.built corpus
	$(BIN)/mocapress bench lossless $(if $(wildcard corpus/.version),corpus/amc/cmu)

# The wheel, tried in an environment that has nothing else.
wheel: $(VENV)/.installed
	rm -rf dist build/fresh
	$(BIN)/pip wheel --quiet --no-deps -w dist .
	$(PYTHON) -m venv build/fresh
	build/fresh/bin/pip install --quiet dist/*.whl
	cd build/fresh && bin/python $(CURDIR)/tests/wheel.py $(CURDIR)/samples

# The developers' clips, where they are.
.PHONY: corpus
corpus:
	@if [ -x $(CORPUS_SOURCE)/unpack ]; then $(PYTHON) $(CORPUS_SOURCE)/unpack corpus; fi

# For developers: the tools, and the package of benchmarks with the rivals that PyPI has.
$(VENV)/.built: $(VENV)/.installed benchmarks/pyproject.toml
	$(BIN)/pip install --quiet --disable-pip-version-check 'mocapress[dev]' --editable ./benchmarks
	@touch $@

$(VENV)/.installed: pyproject.toml CMakeLists.txt cmake/python.cmake $(kernels) $(headers) $(wildcard core/python/*.cpp)
	@command -v $(PYTHON) >/dev/null || { echo "mocapress needs Python 3.11 to 3.13 (Debian: apt-get install python3-venv)"; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "mocapress needs Python 3.11 or later; PYTHON=... names one"; exit 1; }
	@command -v $(CXX) >/dev/null || { echo "mocapress needs a C++20 compiler: g++ 12 or clang 15 (Debian: apt-get install g++)"; exit 1; }
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@echo "building the C++ core: about a minute on one core"
	CXX=$(CXX) $(BIN)/pip install --quiet --disable-pip-version-check --editable .
	@touch $@

clean:
	rm -rf $(VENV) build dist
