/* libmocapress: plays .mcz files, which hold compressed motion capture.
 *
 *     mocapress_clip *clip;
 *     if (mocapress_open_file("walk.mcz", &clip) != MOCAPRESS_OK) die(mocapress_message());
 *     double *positions = malloc(mocapress_points(clip) * 3 * sizeof(double));
 *     mocapress_pose(clip, 1.25, MOCAPRESS_WORLD, positions, NULL);
 *     mocapress_close(clip);
 *
 * Files coded by `exact` (without a model), `near`, `patterns` and `qssd` are decoded. A clip may be
 * used by one thread at a time, different clips by different threads. Lengths and axes are those of
 * the file. Nothing here prints, aborts or throws, whatever a file holds.
 */
#ifndef MOCAPRESS_H
#define MOCAPRESS_H

#include <stddef.h>

#if defined(_WIN32)
#define MOCAPRESS_API __declspec(dllexport)
#else
#define MOCAPRESS_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct mocapress_clip mocapress_clip;

typedef enum mocapress_status {
  MOCAPRESS_OK = 0,
  MOCAPRESS_CANNOT_READ = 1,  /* the file cannot be opened or read */
  MOCAPRESS_CORRUPT = 2,      /* damaged, or no .mcz */
  MOCAPRESS_UNSUPPORTED = 3,  /* another codec, no motion, no skeleton, stretched bones */
  MOCAPRESS_NO_MEMORY = 4,
  MOCAPRESS_BAD_ARGUMENT = 5, /* a null pointer, a frame that is not there, a time that is none */
  MOCAPRESS_NO_RATE = 6       /* the file does not state its sampling rate: mocapress_set_rate */
} mocapress_status;

typedef enum mocapress_space {
  MOCAPRESS_WORLD = 0, /* in space */
  MOCAPRESS_LOCAL = 1  /* relative to the parent */
} mocapress_space;

/* What was wrong in this thread's last call that failed; empty before the first. */
MOCAPRESS_API const char *mocapress_message(void);

/* Opens a file. All of it is read and its checksums are checked; chunks are decoded when needed. */
MOCAPRESS_API mocapress_status mocapress_open_file(const char *path, mocapress_clip **clip);
/* Opens the contents of a file, of which a copy is taken. */
MOCAPRESS_API mocapress_status mocapress_open(const void *data, size_t size, mocapress_clip **clip);
MOCAPRESS_API void mocapress_close(mocapress_clip *clip);

MOCAPRESS_API size_t mocapress_frames(const mocapress_clip *clip);
/* Numbers of a frame, as the motion file had them. */
MOCAPRESS_API size_t mocapress_channels(const mocapress_clip *clip);
/* 0 without a skeleton. */
MOCAPRESS_API size_t mocapress_joints(const mocapress_clip *clip);
/* Joints, then the ends of bones without further joints. */
MOCAPRESS_API size_t mocapress_points(const mocapress_clip *clip);
/* UTF-8, good until the clip is closed; empty where there is no such joint. */
MOCAPRESS_API const char *mocapress_joint_name(const mocapress_clip *clip, size_t joint);
/* The joint that a point hangs on; -1 for a root and where there is no such point. */
MOCAPRESS_API ptrdiff_t mocapress_parent(const mocapress_clip *clip, size_t point);
/* Centimetres in a unit of length, where the file says it; else 0. */
MOCAPRESS_API double mocapress_unit(const mocapress_clip *clip);

/* Seconds a frame lasts; 0 where it is not known. */
MOCAPRESS_API double mocapress_frame_time(const mocapress_clip *clip);
/* Sets the rate in frames per second. */
MOCAPRESS_API mocapress_status mocapress_set_rate(mocapress_clip *clip, double rate);

/* Decodes the chunks that poses at a time need, if they are not decoded yet. Two chunks are kept. */
MOCAPRESS_API mocapress_status mocapress_seek(mocapress_clip *clip, double seconds);

/* The pose at a time: before the first frame that of the first, behind the last that of the last,
 * between two frames rotations at constant speed the shorter way and lines between places.
 *
 * positions: 3 numbers for each point; rotations: 4 for each joint, unit quaternions with the scalar
 * first. Either may be NULL. Where the time's chunks are decoded, nothing is allocated.
 */
MOCAPRESS_API mocapress_status mocapress_pose(mocapress_clip *clip, double seconds,
                                              mocapress_space space, double *positions,
                                              double *rotations);

/* The numbers of a frame, mocapress_channels of them: with `exact` those of the motion file. */
MOCAPRESS_API mocapress_status mocapress_values(mocapress_clip *clip, size_t frame, double *values);

#ifdef __cplusplus
}
#endif

#endif
