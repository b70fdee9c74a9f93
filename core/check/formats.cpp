// Prints digests of what is read from made-up motion files, and of where it places their joints, to
// compare builds with each other.
#include <cstddef>
#include <string>
#include <vector>

#include "check/motion.hpp"
#include "formats/motion_file.hpp"
#include "formats/text.hpp"
#include "motion/kinematics.hpp"
#include "numbers/text.hpp"

namespace check = mocapress::check;

namespace {

constexpr std::size_t kFrames = 200;

const std::string kHierarchy =
    "HIERARCHY\nROOT Hüfte\n{\n  OFFSET 0.5 -0.25 1e-3\n"
    "  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
    "  JOINT knee\n  {\n    OFFSET 0 -41.25 0.125\n    CHANNELS 3 Xrotation Yrotation Xrotation\n"
    "    JOINT foot\n    {\n      OFFSET 0.1 -39.9 .3\n      CHANNELS 4 Yscale Zrotation "
    "Yrotation\n"
    "      Xrotation\n      End Site { OFFSET 0 -5 12 }\n    }\n  }\n}\n"
    "MOTION\nFrames: 200\nFrame Time: .0083333\n";

const std::string kSkeleton =
    ":units\n length 0.45\n angle deg\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n"
    " position 0 1 2\n orientation 10 20 30\n:bonedata\n"
    " begin\n  name lhip\n  direction 0.6 -0.7 0.2\n  length 2.4\n  axis 10 -20 33.3 ZYX\n"
    "  dof rx ry rz\n  limits (-160 20)\n  (-inf,inf)\n  (1 2)\n end\n"
    " begin\n  name foot\n  direction 0 -1 1\n  length 1.75\n  axis 0 0 90 XYZ\n  dof tz rx\n end\n"
    ":hierarchy\n begin\n  root lhip\n  lhip foot\n end\n";

std::string printed(double value) {
  char text[mocapress::kLongestNumber];
  const mocapress::NumberFormat format{mocapress::NumberKind::trimmed, 4};
  return std::string(text, mocapress::print_number(text, value, format));
}

// The numbers of a frame, `parts` of them behind a word each.
std::string amc_of(const std::vector<double>& values, std::size_t columns) {
  std::string text = ":FULLY-SPECIFIED\n:DEGREES\n:SAMPLES-PER-SECOND 59.94\n";
  for (std::size_t f = 0; f < kFrames; ++f) {
    text += std::to_string(f + 1) + "\nroot";
    for (std::size_t c = 0; c < columns; ++c) {
      // Every seventh frame leaves the foot out.
      if (c == 9 && f % 7 == 6) break;
      if (c == 6) text += "\nlhip";
      if (c == 9) text += "\nfoot";
      text += ' ' + printed(values[f * columns + c]);
    }
    text += '\n';
  }
  return text;
}

std::string bvh_of(const std::vector<double>& values, std::size_t columns, const char* gap,
                   const char* end) {
  std::string text = kHierarchy;
  for (std::size_t i = 0; i < values.size(); ++i)
    text += printed(values[i]) + (i % columns + 1 < columns ? gap : end);
  return text;
}

std::string words(const mocapress::Problem& problem) {
  return problem.what + "; expected " + problem.expected + "; found " + problem.found + " (" +
         std::to_string(problem.line) + ", " + std::to_string(problem.offset) + ")\n";
}

void check_one(const std::string& name, const mocapress::MotionFile& file,
               const mocapress::Skeleton& skeleton) {
  std::string facts = file.frame_time;
  if (file.fault) facts += words(*file.fault);
  for (const auto& problem : file.problems) facts += words(problem);
  std::vector<mocapress::ChannelPlace> columns;
  for (const auto& column : file.columns) {
    facts += column.name + ' ' + std::to_string(column.joint) + ' ';
    std::size_t kind = 0;
    while (kind + 1 < mocapress::kKindNames.size() && mocapress::kKindNames[kind] != column.kind)
      ++kind;
    columns.push_back({column.joint, static_cast<mocapress::Kind>(kind)});
  }
  std::printf("%s: %zu frames, %016llx\n", name.c_str(), file.body.rows(),
              static_cast<unsigned long long>(check::digest(facts.data(), facts.size())));
  check::report(name + ", numbers", file.body.values);
  const mocapress::Rig rig(skeleton, columns, false);
  std::vector<double> places(rig.points() * 3 * file.body.rows());
  std::vector<double> turns(rig.joints() * 4 * file.body.rows());
  for (std::size_t f = 0; f < file.body.rows(); ++f) {
    rig.place(file.body.values.data() + f * file.body.columns, places.data() + f * rig.points() * 3,
              turns.data() + f * rig.joints() * 4);
  }
  check::report(name + ", places", places);
  check::report(name + ", turns", turns);
}

void check_bvh(const std::string& name, const std::string& text) {
  const auto file = mocapress::read_bvh(text);
  check_one("BVH, " + name, file, file.skeleton.value_or(mocapress::Skeleton()));
}

}  // namespace

int main() {
  constexpr std::size_t kBvh = 13;
  constexpr std::size_t kAmc = 11;
  const auto turning = check::motion(kFrames, kBvh, 1);
  const std::string rows = bvh_of(turning, kBvh, " ", "\n");
  check_bvh("rows", rows);
  check_bvh("one number a line", bvh_of(turning, kBvh, "\r", "\r"));
  check_bvh("all on a line", bvh_of(turning, kBvh, "\t", " "));
  check_bvh("cut", rows.substr(0, rows.size() - 1000));
  check_bvh("too long", rows + rows.substr(rows.size() - 500));
  check_bvh("cut in the hierarchy", rows.substr(0, 300));
  const std::string amc = amc_of(check::motion(kFrames, kAmc, 2), kAmc);
  const auto asf = mocapress::read_asf(kSkeleton);
  if (asf.fault) std::printf("NOT RESTORED: %s\n", asf.fault->what.c_str());
  check_one("AMC", mocapress::read_amc(amc, &asf.skeleton), asf.skeleton);
  check_one("AMC without skeleton", mocapress::read_amc(amc, nullptr), {});
  check_one("AMC, cut", mocapress::read_amc(amc.substr(0, amc.size() - 9), &asf.skeleton),
            asf.skeleton);
  return 0;
}
