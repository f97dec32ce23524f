// SPDX-License-Identifier: Apache-2.0
//
// Present-day software for table 6: the equations in double and float, single-threaded.
#define _GNU_SOURCE
#include <math.h>
#include <time.h>

#define REAL double
#define NAME(x) x##_double
#define POSE pose_double
#define SQRT sqrt
#define FABS fabs
#define RINT rint
#define COPYSIGN copysign
#include "equations.h"
#define SOLVE NAME(lean)
#define WAY(x) NAME(lean_##x)
#include "ways.h"
#define SOLVE NAME(paper)
#define WAY(x) NAME(paper_##x)
#include "ways.h"
#undef REAL
#undef NAME
#undef POSE
#undef SQRT
#undef FABS
#undef RINT
#undef COPYSIGN

#define REAL float
#define NAME(x) x##_float
#define POSE pose_float
#define SQRT sqrtf
#define FABS fabsf
#define RINT rintf
#define COPYSIGN copysignf
#include "equations.h"
#define SOLVE NAME(lean)
#define WAY(x) NAME(lean_##x)
#include "ways.h"
#define SOLVE NAME(paper)
#define WAY(x) NAME(paper_##x)
#include "ways.h"
