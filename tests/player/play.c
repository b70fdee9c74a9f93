/* Prints what libmocapress says of a file, for test_player.py to compare with Python; see USAGE. */
#include <mocapress.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char *USAGE =
    "play poses FILE RATE world|local SECONDS...   positions, then rotations, a pose a line\n"
    "play values FILE FRAME...                     numbers of frames\n"
    "play facts FILE                               sizes, names, parents\n"
    "play open FILE...                             the status of each, and its message\n"
    "play allocations FILE RATE POSES              of so many poses in the first chunk\n"
    "play speed FILE RATE POSES                    nanoseconds of processor time a pose\n";

static size_t allocations = 0;

/* Counts, and has glibc do the work. */
extern void *__libc_malloc(size_t size);
void *malloc(size_t size) {
  ++allocations;
  return __libc_malloc(size);
}

static void check(mocapress_status status) {
  if (status == MOCAPRESS_OK) return;
  fprintf(stderr, "status %d: %s\n", status, mocapress_message());
  exit(1);
}

static void print(const double *numbers, size_t count) {
  for (size_t i = 0; i < count; ++i) printf(i ? " %.17g" : "%.17g", numbers[i]);
  printf("\n");
}

static mocapress_clip *opened(const char *file, double rate) {
  mocapress_clip *clip;
  check(mocapress_open_file(file, &clip));
  if (rate > 0) check(mocapress_set_rate(clip, rate));
  return clip;
}

static int poses(int count, char **arguments) {
  mocapress_clip *clip = opened(arguments[0], atof(arguments[1]));
  const mocapress_space space = strcmp(arguments[2], "local") ? MOCAPRESS_WORLD : MOCAPRESS_LOCAL;
  const size_t points = mocapress_points(clip) * 3, joints = mocapress_joints(clip) * 4;
  double *places = malloc(points * sizeof(double)), *turns = malloc(joints * sizeof(double));
  for (int i = 3; i < count; ++i) {
    check(mocapress_pose(clip, atof(arguments[i]), space, places, turns));
    print(places, points);
    print(turns, joints);
  }
  free(places);
  free(turns);
  mocapress_close(clip);
  return 0;
}

static int values(int count, char **arguments) {
  mocapress_clip *clip = opened(arguments[0], 0);
  double *row = malloc(mocapress_channels(clip) * sizeof(double));
  for (int i = 1; i < count; ++i) {
    check(mocapress_values(clip, strtoul(arguments[i], NULL, 10), row));
    print(row, mocapress_channels(clip));
  }
  free(row);
  mocapress_close(clip);
  return 0;
}

static int facts(char **arguments) {
  mocapress_clip *clip = opened(arguments[0], 0);
  printf("%zu %zu %zu %zu\n%.17g %.17g\n", mocapress_frames(clip), mocapress_channels(clip),
         mocapress_joints(clip), mocapress_points(clip), mocapress_frame_time(clip),
         mocapress_unit(clip));
  for (size_t i = 0; i < mocapress_points(clip); ++i) {
    printf("%td %s\n", mocapress_parent(clip, i), mocapress_joint_name(clip, i));
  }
  mocapress_close(clip);
  return 0;
}

static int open_all(int count, char **arguments) {
  for (int i = 0; i < count; ++i) {
    mocapress_clip *clip;
    mocapress_status status = mocapress_open_file(arguments[i], &clip);
    for (size_t f = 0; status == MOCAPRESS_OK && f < mocapress_frames(clip); f += 100) {
      double *row = malloc((mocapress_channels(clip) + 1) * sizeof(double));
      status = mocapress_values(clip, f, row);
      free(row);
    }
    printf("%d %s\n", status, status == MOCAPRESS_OK ? "" : mocapress_message());
    mocapress_close(clip);
  }
  return 0;
}

/* Poses all over the first chunk, none of them at a frame. */
static void play(mocapress_clip *clip, double *places, double *turns, int count) {
  const double span = mocapress_frame_time(clip) * 200;
  for (int i = 0; i < count; ++i) {
    check(mocapress_pose(clip, span * (i * 0.6180339887 - (int)(i * 0.6180339887)), MOCAPRESS_WORLD,
                         places, turns));
  }
}

static int measure(char **arguments, int speed) {
  mocapress_clip *clip = opened(arguments[0], atof(arguments[1]));
  double *places = malloc(mocapress_points(clip) * 3 * sizeof(double));
  double *turns = malloc(mocapress_joints(clip) * 4 * sizeof(double));
  const int count = atoi(arguments[2]);
  check(mocapress_seek(clip, 0));
  const size_t before = allocations;
  const clock_t begin = clock();
  play(clip, places, turns, count);
  const double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
  if (speed) {
    printf("%.0f\n", seconds / count * 1e9);
  } else {
    printf("%zu %d\n", allocations - before, before > 0);
  }
  free(places);
  free(turns);
  mocapress_close(clip);
  return 0;
}

int main(int count, char **arguments) {
  const char *what = count > 2 ? arguments[1] : "";
  if (!strcmp(what, "poses") && count > 5) return poses(count - 2, arguments + 2);
  if (!strcmp(what, "values")) return values(count - 2, arguments + 2);
  if (!strcmp(what, "facts")) return facts(arguments + 2);
  if (!strcmp(what, "open")) return open_all(count - 2, arguments + 2);
  if (!strcmp(what, "allocations") && count > 4) return measure(arguments + 2, 0);
  if (!strcmp(what, "speed") && count > 4) return measure(arguments + 2, 1);
  fputs(USAGE, stderr);
  return 2;
}
