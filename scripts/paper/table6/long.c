// SPDX-License-Identifier: Apache-2.0
//
// The equations of table 6 in long double, for `make soak AGAINST=c`; not timed. Sine and cosine are accurate to 5e-17,
// everything else to the type's 64 bits where available.
#include <math.h>

#define REAL long double
#define NAME(x) x##_long
#define POSE pose_long
#define SQRT sqrtl
#define FABS fabsl
#define RINT rintl
#include "equations.h"

#define POSES(name)                                                                                                       \
  void name##_poses(long n, const REAL *x, const REAL *y, const REAL *z, const REAL *phi, const REAL *d1, const REAL *d2, \
                    double *q) {                                                                                          \
    for (long k = 0; k < n; k++, q += 6) {                                                                                \
      POSE p = NAME(name)(x[k], y[k], z[k], phi[k], d1[k], d2[k]);                                                        \
      q[0] = (double)p.qs_w, q[1] = (double)p.qs_i, q[2] = (double)p.qs_j, q[3] = (double)p.qs_k;                         \
      q[4] = (double)p.qe_w, q[5] = (double)p.qe_i;                                                                       \
    }                                                                                                                     \
  }
POSES(lean)
POSES(paper)
