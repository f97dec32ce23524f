// The calls in floating point. Lengths: Q2.30, rounded half to even, saturated. phi: one turn = 2^32, rounded half to
// even, wrapped. qs, qe: exact.
// SPDX-License-Identifier: Apache-2.0
#include "ik.h"

#include <float.h>
#include <limits.h>

typedef char ik_needs_double_of_64_bits[DBL_MANT_DIG == 53 && sizeof(double) == 8 ? 1 : -1];

enum { FRACTION = 30, HEADROOM = 4 }; // fraction bits of a length, low bits that scaling may drop

static const double TURN = 6.283185307179586;

// ---- numbers: a double is digits * 2^exponent ----

typedef struct {
    uint64_t digits;
    int exponent;
    bool negative;
} parts;

static parts parts_of(double value) {
    const union {
        double value;
        uint64_t bits;
    } is = {value};
    const uint64_t one = UINT64_C(1) << 52;
    const int biased = (int)(is.bits >> 52 & 0x7ff);
    const uint64_t digits = (is.bits & (one - 1)) | (biased ? one : 0);
    return (parts){digits, (biased ? biased : 1) - 1075, is.bits >> 63 != 0};
}

static bool finite(double value) {
    return parts_of(value).exponent < 0x7ff - 1075;
}

// Returns the greatest e with value * 2^e in [-2, 2); INT_MAX for 0.
static int fits(double value) {
    const parts is = parts_of(value);
    if (is.digits == 0) return INT_MAX;
    int top = is.exponent + 53; // |value| < 2^top
    for (uint64_t digits = is.digits; !(digits >> 52); digits <<= 1) top--;
    const bool power = (is.digits & (is.digits - 1)) == 0;
    return (is.negative && power ? 2 : 1) - top;
}

// Returns value * 2^e, rounded half to even, modulo 2^64.
static uint64_t rounded(double value, int e) {
    const parts is = parts_of(value);
    const int up = is.exponent + e;
    uint64_t word = 0;
    if (up >= 0) {
        word = up < 64 ? is.digits << up : 0;
    } else if (up > -64) {
        const uint64_t rest = is.digits << (64 + up); // the dropped bits, left-aligned
        const uint64_t half = UINT64_C(1) << 63;
        word = is.digits >> -up;
        word += rest > half || (rest == half && (word & 1));
    }
    return is.negative ? 0 - word : word;
}

static int32_t length_word(double value, int exponent) {
    const uint64_t word = rounded(value, exponent + FRACTION);
    return (int32_t)((uint32_t)word - (word == UINT64_C(1) << 31)); // a word rounded to +2 saturates
}

static ik_real value_of(int32_t word) {
    return (ik_real)((double)word / (1 << FRACTION));
}

static ik_real angle_of(int32_t word) {
    return (ik_real)(word * (TURN / 4294967296.0));
}

// ---- targets and results in memory ----

// Arrays of a call: targets and results or, if hands is not null, hands and joints.
typedef struct {
    const ik_target *targets;
    const ik_hand *hands;
    ik_result *results;
    ik_joints *joints;
} lists;

static ik_hand target_of(const lists *of, size_t k) {
    if (of->hands) return of->hands[k];
    const ik_target *t = &of->targets[k];
    return (ik_hand){.x = t->x, .y = t->y, .z = t->z, .phi = t->phi, .d1 = t->d1, .d2 = t->d2, .tag = t->tag};
}

// Computes the scaling exponent e: the greatest with every reach * 2^e in [0, 2), coordinate * 2^e in [-2, 2) and
// |tool| * 2^e below 2. Fails if the coordinates lower e by more than HEADROOM, or the tools then lower it by more.
static ik_code scale(ik_core *core, const lists *of, size_t n, int *exponent) {
    int longest = INT_MAX, furthest = INT_MAX, tools = INT_MAX;
    size_t far = 0, shortest = 0, tool = 0;
    double least = DBL_MAX;
    for (size_t k = 0; k < n; k++) {
        const ik_hand one = target_of(of, k), *t = &one;
        core->bad = k;
        if (!finite(t->tool)) return IK_NOT_FINITE;
        for (int i = 0; i < 4; i++)
            if (fits(t->hand[i]) < 0) return IK_NOT_A_HAND;
        if (fits(t->tool < 0 ? -t->tool : t->tool) < tools) {
            tools = fits(t->tool < 0 ? -t->tool : t->tool);
            tool = k;
        }
        if (!(finite(t->x) && finite(t->y) && finite(t->z) && finite(t->phi) && finite(t->d1) && finite(t->d2)))
            return IK_NOT_FINITE;
        if (!(t->d1 > 0 && t->d2 > 0)) return IK_NOT_AN_ARM;
        const double reach = (double)t->d1 + t->d2, d = t->d1 < t->d2 ? t->d1 : t->d2;
        if (!finite(reach)) return IK_TOO_FAR_OUT;
        if (fits(reach) < longest) longest = fits(reach);
        const double position[3] = {t->x, t->y, t->z};
        for (int i = 0; i < 3; i++) {
            if (fits(position[i]) >= furthest) continue;
            furthest = fits(position[i]);
            far = k;
        }
        if (d >= least) continue;
        least = d;
        shortest = k;
    }
    core->bad = far;
    if (furthest < longest - HEADROOM) return IK_TOO_FAR_OUT;
    *exponent = furthest < longest ? furthest : longest;
    core->bad = tool;
    if (tools < *exponent - HEADROOM) return IK_TOO_FAR_OUT;
    if (tools < *exponent) *exponent = tools;
    core->bad = shortest;
    const int32_t ulp = INT32_C(1) << (32 - core->width);
    if (length_word(least, *exponent) < ulp - ulp / 2) return IK_TOO_SHORT; // the core rounds half up
    core->bad = 0;
    return IK_OK;
}

// Writes a record word by word: the buffer may be uncached memory that permits no other accesses.
static void put_record(uint32_t *at, const void *record, size_t bytes) {
    volatile uint32_t *to = at;
    for (size_t i = 0; i < bytes / 4; i++) to[i] = ((const uint32_t *)record)[i];
}

static void put_target(const ik_core *core, uint32_t place, const lists *of, size_t k, int exponent) {
    const ik_hand t = target_of(of, k);
    ik_hand_words record = {.phi = (uint32_t)rounded(t.phi / TURN, 32), .tag = t.tag};
    record.x = length_word(t.x, exponent);
    record.y = length_word(t.y, exponent);
    record.z = length_word(t.z, exponent);
    record.d1 = length_word(t.d1, exponent);
    record.d2 = length_word(t.d2, exponent);
    if (of->hands) {
        record.tool = length_word(t.tool, exponent);
        record.tag = (uint32_t)t.branch << 24 | (t.tag & 0xffffffu);
        for (int i = 0; i < 4; i++) record.hand[i] = length_word(t.hand[i], 0);
        put_record(core->bus.source.at + place * 16, &record, sizeof record);
    } else {
        const ik_target_words wrist = {record.x, record.y, record.z, record.phi, record.d1, record.d2, t.tag, 0};
        put_record(core->bus.source.at + place * 8, &wrist, sizeof wrist);
    }
}

static void take_result(const ik_core *core, uint32_t place, const lists *of, size_t k) {
    const ik_joints_words *joints = &ik_joints_records(core)[place];
    const ik_result_words *result = &ik_result_records(core)[place];
    const int32_t *qs = of->hands ? joints->qs : result->qs, *qe = of->hands ? joints->qe : result->qe;
    const uint32_t tag = of->hands ? joints->tag : result->tag;
    ik_joints r = {.tag = tag & 0xffffffu, .flags = (uint8_t)(tag >> 24)};
    for (int i = 0; i < 4; i++) r.qs[i] = value_of(qs[i]);
    for (int i = 0; i < 2; i++) r.qe[i] = value_of(qe[i]);
    if (of->hands) {
        for (int i = 0; i < 7; i++) r.th[i] = angle_of(joints->th[i]);
        r.over_limit = (uint16_t)joints->over_limit;
        of->joints[k] = r;
    } else {
        of->results[k] = (ik_result){{r.qs[0], r.qs[1], r.qs[2], r.qs[3]}, {r.qe[0], r.qe[1]}, r.tag, r.flags};
    }
}

// ---- interface ----

// Solves all targets of a call, in jobs that fit the buffers.
static ik_code solve(ik_core *core, const lists *of, size_t n) {
    if (!core->width) return IK_NO_CORE;
    if (core->arm != (of->hands != NULL)) return IK_OTHER_CORE;
    core->written = core->bad = 0;
    core->error_address = 0;
    core->aborted = false;
    if (!n) return IK_NO_TARGETS;
    int exponent = 0;
    ik_code code = scale(core, of, n, &exponent);
    while (!code && core->written < n) {
        const size_t first = core->written, left = n - first;
        const uint32_t part = left < core->bus.records ? (uint32_t)left : core->bus.records;
        if (ik_busy(core)) return IK_BUSY;
        for (uint32_t k = 0; k < part; k++) put_target(core, k, of, first + k, exponent);
        code = ik_job(core, part);
        for (uint32_t k = 0; first + k < core->written; k++) take_result(core, k, of, first + k);
    }
    return code;
}

ik_code ik_solve(ik_core *core, const ik_target *targets, ik_result *results, size_t n) {
    if (!core || !targets || !results) return IK_NULL;
    return solve(core, &(lists){.targets = targets, .results = results}, n);
}

ik_code ik_solve_arm(ik_core *core, const ik_hand *hands, ik_joints *results, size_t n) {
    if (!core || !hands || !results) return IK_NULL;
    return solve(core, &(lists){.hands = hands, .joints = results}, n);
}

ik_code ik_limits(ik_core *core, const ik_real low[7], const ik_real high[7]) {
    if (!core || !low || !high) return IK_NULL;
    if (!core->width) return IK_NO_CORE;
    if (!core->arm) return IK_OTHER_CORE;
    const double unit = (double)(UINT64_C(1) << core->width) / TURN, most = 4e18;
    const unsigned below = 32 - core->width;
    uint32_t lowest[7], highest[7];
    for (int k = 0; k < 7; k++) {
        const double from = low[k] * unit, to = high[k] * unit;
        core->bad = (size_t)k;
        lowest[k] = UINT32_C(1) << 31;
        highest[k] = lowest[k] - 1;
        if (!(low[k] <= high[k])) return IK_BAD_LIMITS;
        if (!((double)high[k] - low[k] < TURN)) continue;
        if (!(-most < from && to < most)) return IK_BAD_LIMITS;
        int64_t first = (int64_t)from, last = (int64_t)to; // toward 0
        first += (double)first < from;
        last -= (double)last > to;
        if (first > last) return IK_BAD_LIMITS;
        lowest[k] = (uint32_t)((uint64_t)first << below);
        highest[k] = (uint32_t)((uint64_t)last << below);
    }
    core->bad = 0;
    return ik_limits_words(core, lowest, highest);
}
