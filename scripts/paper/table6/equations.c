// SPDX-License-Identifier: Apache-2.0
//
// Equations of one target in reach: (x, y, z, phi, d1, d2) to (qs_w, qs_i, qs_j, qs_k, qe_w, qe_i), and functions that
// solve many targets. Options of the compiler set REAL, the type, and SOLVE, the set of equations: lean or paper.
// Equation numbers are the paper's, (10)-(18). The lean equations' names are those of model/dataflow/lean.py. The code is
// branch-free, so that a compiler can vectorize it. With long double, sine and cosine are accurate to 5e-17, the rest to 64 bits.
#include <tgmath.h>

#define INLINE static inline __attribute__((always_inline))

typedef struct {
  REAL qs_w, qs_i, qs_j, qs_k, qe_w, qe_i;
} POSE;

// sin and cos of an angle of a few turns: reduction to +-pi/4, then Taylor series, accurate to a few ulps.
INLINE void sin_cos(REAL a, REAL *s, REAL *c) {
  REAL n = rint(a * (REAL)0.63661977236758134308);
  REAL r = a - n * (REAL)1.5707963267341256 - n * (REAL)6.0771005065061922e-11;
  REAL q = r * r;
  REAL sine = r * (1 + q * (-(REAL)1 / 6 + q * ((REAL)1 / 120 + q * (-(REAL)1 / 5040 + q * ((REAL)1 / 362880
              + q * (-(REAL)1 / 39916800 + q * ((REAL)1 / 6227020800 + q * (-(REAL)1 / 1307674368000))))))));
  REAL cosine = 1 + q * (-(REAL)1 / 2 + q * ((REAL)1 / 24 + q * (-(REAL)1 / 720 + q * ((REAL)1 / 40320
                + q * (-(REAL)1 / 3628800 + q * ((REAL)1 / 479001600 + q * (-(REAL)1 / 87178291200
                + q * ((REAL)1 / 20922789888000))))))));
  int quarter = (int)n;
  REAL first = quarter & 1 ? cosine : sine;
  REAL second = quarter & 1 ? sine : cosine;
  *s = quarter & 2 ? -first : first;
  *c = (quarter + 1) & 2 ? -second : second;
}

INLINE REAL positive(REAL v) { return v > 0 ? v : 0; }

// Parts of a quaternion for half the angle with cosine c and sine s; its squared length is (1 + |c|)/2.
INLINE void half(REAL c, REAL s, REAL *half_c, REAL *half_s) {
  REAL large = (1 + fabs(c)) / 2, small = s / 2;
  *half_c = c >= 0 ? large : small;
  *half_s = c >= 0 ? small : large;
}

INLINE POSE lean(REAL x, REAL y, REAL z, REAL phi, REAL d1, REAL d2) {
  REAL d_sum = d1 + d2, d_dif = d1 - d2;
  REAL rho_sq = x * x + y * y, s = rho_sq + z * z;
  REAL a_far = positive(d_sum * d_sum - s);
  REAL b_near = positive(s - d_dif * d_dif);
  REAL k_law = s + d_sum * d_dif;
  REAL inv_rho = 1 / sqrt(rho_sq), inv_s = 1 / sqrt(s);
  REAL root_far = sqrt(a_far), root_near = sqrt(b_near);
  REAL u_x = x * inv_rho, u_y = y * inv_rho;
  REAL sin_el = z * inv_s, cos_el = rho_sq * inv_rho * inv_s;
  REAL inv_12 = 1 / (2 * sqrt(d1 * d2)), inv_law = inv_s / (2 * d1);
  REAL qe_w = root_far * inv_12;
  REAL qe_i = -root_near * inv_12;
  REAL cos_a = k_law * inv_law, sin_a = root_far * root_near * inv_law;

  REAL az_c, az_s, tilt_c, tilt_s, bend_c, bend_s, sin_h, cos_h;
  half(-u_y, u_x, &az_c, &az_s);
  half(sin_el, cos_el, &tilt_c, &tilt_s);
  half(cos_a, sin_a, &bend_c, &bend_s);
  sin_cos(phi / 2, &sin_h, &cos_h);
  REAL cc = az_c * cos_h, ss = az_s * sin_h, sc = az_s * cos_h, cs = az_c * sin_h;
  REAL w_0 = tilt_c * (cc - ss), i_0 = tilt_s * (cc + ss), j_0 = tilt_s * (sc - cs), k_0 = tilt_c * (sc + cs);
  REAL w_1 = w_0 * bend_c + i_0 * bend_s, i_1 = i_0 * bend_c - w_0 * bend_s;
  REAL j_1 = j_0 * bend_c - k_0 * bend_s, k_1 = k_0 * bend_c + j_0 * bend_s;
  REAL length_sq = (1 + fabs(u_y)) * (1 + fabs(sin_el)) * (1 + fabs(cos_a)) / 8;
  REAL inv_q = (k_1 < 0 ? (REAL)-1 : (REAL)1) / sqrt(length_sq);
  return (POSE){w_1 * inv_q, i_1 * inv_q, j_1 * inv_q, k_1 * inv_q, qe_w, qe_i};
}

INLINE POSE paper(REAL x, REAL y, REAL z, REAL phi, REAL d1, REAL d2) {
  REAL l_sw = sqrt(x * x + y * y + z * z);                                   // (10)
  REAL sin_h, cos_h;
  sin_cos(phi / 2, &sin_h, &cos_h);
  REAL n_x = (2 * cos_h * sin_h * z * x - y * l_sw + 2 * y * l_sw * cos_h * cos_h) / l_sw;             // (11)
  REAL n_y = (2 * cos_h * sin_h * z * y + x * l_sw - 2 * x * l_sw * cos_h * cos_h) / l_sw;             // (11)
  REAL n_z = -2 * sin_h * cos_h * (x * x + y * y) / l_sw;                    // (11)
  REAL law = (x * x + z * z + y * y + d1 * d1 - d2 * d2) / 2;
  REAL pp_i = n_x * law, pp_j = n_y * law, pp_k = n_z * law;                 // (12)
  REAL m_1 = z * n_y - y * n_z, m_2 = x * n_z - z * n_x, m_3 = y * n_x - x * n_y;                      // (19)
  REAL inf_pp = m_3 * m_3 + m_1 * m_1 + m_2 * m_2;                           // (13)
  REAL tmp1 = -pp_i * pp_i - pp_j * pp_j - pp_k * pp_k + d1 * d1 * m_1 * m_1 + d1 * d1 * m_2 * m_2
              + d1 * d1 * m_3 * m_3;                                         // (13), (19)
  REAL root = sqrt(positive(tmp1));                                          // (13)
  REAL e_x = (-pp_j * m_3 + pp_k * m_2 + root * m_1) / inf_pp;               // (13)
  REAL e_y = (pp_i * m_3 - pp_k * m_1 + root * m_2) / inf_pp;                // (13)
  REAL e_z = (pp_j * m_1 - pp_i * m_2 + root * m_3) / inf_pp;                // (13)

  REAL c4 = (e_x * e_x - e_x * x + e_y * e_y - e_y * y - e_z * z + e_z * e_z) / (d1 * d2);             // (14)
  REAL qe_w = sqrt(positive((1 + c4) / 2));                                  // (14)
  REAL qe_i = -sqrt(positive((1 - c4) / 2));                                 // (14)

  REAL rho_sq = e_x * e_x + e_y * e_y, below = d1 - e_z;
  REAL l_m = sqrt(d1 * d1 * rho_sq * (below * below + rho_sq));              // (15)
  REAL q_i = d1 * e_x * below / l_m, q_j = d1 * e_y * below / l_m, q_k = d1 * rho_sq / l_m;            // (15)
  REAL flat = q_i * q_i - q_k * q_k - q_j * q_j;
  REAL c3 = (-n_x * flat - 2 * q_i * (q_j * n_y + q_k * n_z)) / sqrt(n_x * n_x + n_y * n_y + n_z * n_z);  // (17)
  REAL side = x * flat + 2 * q_i * (q_k * z + q_j * y);                      // (17)
  REAL q3 = sqrt(positive((1 + c3) / 2));                                    // (17)
  REAL q3_k = (side < 0 ? (REAL)-1 : (REAL)1) * sqrt(positive((1 - c3) / 2));                          // (17)
  return (POSE){-q_k * q3_k, q_i * q3 + q_j * q3_k, q_j * q3 - q_i * q3_k, q_k * q3, qe_w, qe_i};      // (18)
}

#define ARGUMENTS                                                                                                    \
  long times, long n, const REAL *restrict x, const REAL *restrict y, const REAL *restrict z,                        \
      const REAL *restrict phi, const REAL *restrict d1, const REAL *restrict d2, REAL *restrict qs_w,               \
      REAL *restrict qs_i, REAL *restrict qs_j, REAL *restrict qs_k, REAL *restrict qe_w, REAL *restrict qe_i
#define STORE                                                                                                        \
  qs_w[k] = q.qs_w, qs_i[k] = q.qs_i, qs_j[k] = q.qs_j, qs_k[k] = q.qs_k, qe_w[k] = q.qe_w, qe_i[k] = q.qe_i

// Independent targets. Compiled twice: scalar, and with several targets per instruction.
void batch(ARGUMENTS) {
  for (long t = 0; t < times; t++) {
    for (long k = 0; k < n; k++) {
      POSE q = SOLVE(x[k], y[k], z[k], phi[k], d1[k], d2[k]);
      STORE;
    }
    __asm__ volatile("" ::: "memory");  // keeps every repetition
  }
}

#ifdef ARM  // not for every C library: it needs atan2 of every type
// Converts a quaternion Rz(a) Rx(b) Rz(c) to the angles a, b, c. The results for a and c may be off by a turn.
INLINE void zxz(REAL w, REAL i, REAL j, REAL k, REAL *a, REAL *b, REAL *c) {
  REAL s = atan2(k, w), d = atan2(j, i);
  *a = s + d, *b = 2 * atan2(sqrt(i * i + j * j), sqrt(w * w + k * k)), *c = s - d;
}

// Converts independent hand poses to seven joints, by SOLVE and the equations of model/reference/joints.py.
void arm(long times, long n, const REAL *restrict x, const REAL *restrict y, const REAL *restrict z,
         const REAL *restrict phi, const REAL *restrict d1, const REAL *restrict d2, const REAL *restrict tool,
         const REAL *restrict h_w, const REAL *restrict h_i, const REAL *restrict h_j, const REAL *restrict h_k,
         REAL *restrict th1, REAL *restrict th2, REAL *restrict th3, REAL *restrict th4, REAL *restrict th5,
         REAL *restrict th6, REAL *restrict th7) {
  for (long t = 0; t < times; t++) {
    for (long m = 0; m < n; m++) {
      REAL w = h_w[m], i = h_i[m], j = h_j[m], k = h_k[m];
      POSE q = SOLVE(x[m] - 2 * (i * k + w * j) * tool[m], y[m] - 2 * (j * k - w * i) * tool[m],
                     z[m] - ((w * w + k * k) - (i * i + j * j)) * tool[m], phi[m], d1[m], d2[m]);
      REAL s = q.qe_w, c = -q.qe_i;  // th4 / 2
      REAL f_w = q.qs_w * c - q.qs_i * s, f_i = q.qs_w * s + q.qs_i * c;  // forearm
      REAL f_j = q.qs_j * c + q.qs_k * s, f_k = q.qs_k * c - q.qs_j * s;
      zxz(q.qs_w, q.qs_i, q.qs_j, q.qs_k, &th1[m], &th2[m], &th3[m]);
      th4[m] = 2 * atan2(s, c);
      zxz(f_w * w + f_i * i + f_j * j + f_k * k, f_w * i - f_i * w - f_j * k + f_k * j,
          f_w * j - f_j * w - f_k * i + f_i * k, f_w * k - f_k * w - f_i * j + f_j * i, &th5[m], &th6[m], &th7[m]);
    }
    __asm__ volatile("" ::: "memory");
  }
}
#endif

// Each target waits for the complete previous answer, as in a control loop: measures the latency of a solve.
void chain(ARGUMENTS) {
  REAL before = 0;
  for (long t = 0; t < times; t++) {
    for (long k = 0; k < n; k++) {
      POSE q = SOLVE(x[k] + before, y[k] + before, z[k] + before, phi[k] + before, d1[k] + before, d2[k] + before);
      STORE;
      before = copysign((REAL)0, (q.qs_w + q.qs_i) + (q.qs_j + q.qs_k) + (q.qe_w + q.qe_i));  // 0, but known only then
    }
    __asm__ volatile("" ::: "memory");
  }
}
