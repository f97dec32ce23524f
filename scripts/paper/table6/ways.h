// SPDX-License-Identifier: Apache-2.0
//
// Repeated solution of many targets by SOLVE. Included once per type and set of equations.

#define ARGUMENTS                                                                                                    \
  long times, long n, const REAL *restrict x, const REAL *restrict y, const REAL *restrict z,                        \
      const REAL *restrict phi, const REAL *restrict d1, const REAL *restrict d2, REAL *restrict qs_w,               \
      REAL *restrict qs_i, REAL *restrict qs_j, REAL *restrict qs_k, REAL *restrict qe_w, REAL *restrict qe_i
#define STORE                                                                                                        \
  qs_w[k] = q.qs_w, qs_i[k] = q.qs_i, qs_j[k] = q.qs_j, qs_k[k] = q.qs_k, qe_w[k] = q.qe_w, qe_i[k] = q.qe_i

// Independent targets. Compiled twice: scalar, and with several targets per instruction.
void WAY(batch)(ARGUMENTS) {
  for (long t = 0; t < times; t++) {
    for (long k = 0; k < n; k++) {
      POSE q = SOLVE(x[k], y[k], z[k], phi[k], d1[k], d2[k]);
      STORE;
    }
    __asm__ volatile("" ::: "memory");  // keeps every repetition
  }
}

// Each target waits for the complete previous answer, as in a control loop: measures the latency of a solve.
void WAY(chain)(ARGUMENTS) {
  REAL before = 0;
  for (long t = 0; t < times; t++) {
    for (long k = 0; k < n; k++) {
      POSE q = SOLVE(x[k] + before, y[k] + before, z[k] + before, phi[k] + before, d1[k] + before, d2[k] + before);
      STORE;
      before = COPYSIGN(0, (q.qs_w + q.qs_i) + (q.qs_j + q.qs_k) + (q.qe_w + q.qe_i));  // 0, but known only then
    }
    __asm__ volatile("" ::: "memory");
  }
}

// A chain that reads the clock before and after each target: ns[k], clock reads included. The maximum is the delay that
// a control loop must tolerate.
void WAY(watched)(ARGUMENTS, REAL *restrict ns) {
  struct timespec from, to;
  REAL before = 0;
  for (long t = 0; t < times; t++)
    for (long k = 0; k < n; k++) {
      clock_gettime(CLOCK_MONOTONIC, &from);
      POSE q = SOLVE(x[k] + before, y[k] + before, z[k] + before, phi[k] + before, d1[k] + before, d2[k] + before);
      STORE;
      before = COPYSIGN(0, (q.qs_w + q.qs_i) + (q.qs_j + q.qs_k) + (q.qe_w + q.qe_i));
      __asm__ volatile("" ::: "memory");
      clock_gettime(CLOCK_MONOTONIC, &to);
      ns[k] = (REAL)((to.tv_sec - from.tv_sec) * 1000000000L + (to.tv_nsec - from.tv_nsec));
    }
}

#undef ARGUMENTS
#undef STORE
#undef SOLVE
#undef WAY
