// Lengths: Q2.30, rounded half to even, saturated. phi: one turn = 2^32, rounded half to even, wrapped. qs, qe: exact.
// SPDX-License-Identifier: Apache-2.0
#include "ik.h"

#include <float.h>
#include <limits.h>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "records are little endian"
#endif
typedef char ik_needs_double_of_64_bits[DBL_MANT_DIG == 53 && sizeof(double) == 8 ? 1 : -1];

enum { FRACTION = 30, HEADROOM = 4 }; // fraction bits of a length, low bits that scaling may drop

static const double TURN = 6.283185307179586;

static uint32_t get(const ik_core *core, uint32_t offset) {
    return core->bus.read(core->bus.user, offset);
}

static void set(const ik_core *core, uint32_t offset, uint32_t value) {
    core->bus.write(core->bus.user, offset, value);
}

static uint32_t field(uint32_t value, uint32_t mask, unsigned shift) {
    return (value & mask) >> shift;
}

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

static uint32_t length_word(double value, int exponent) {
    const uint64_t word = rounded(value, exponent + FRACTION);
    return (uint32_t)word - (word == UINT64_C(1) << 31); // a word rounded to +2 saturates
}

static ik_real value_of(uint32_t word) {
    return (ik_real)((double)word / (1 << FRACTION) - (word >> 31 ? 4.0 : 0.0));
}

static ik_real angle_of(uint32_t word) {
    return (ik_real)(((double)word - (word >> 31 ? 4294967296.0 : 0.0)) * (TURN / 4294967296.0));
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

static size_t words_of(const lists *of) { // 32-bit words per record
    return of->hands ? 16 : 8;
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
    const uint32_t ulp = UINT32_C(1) << (32 - core->width);
    if (length_word(least, *exponent) < ulp - ulp / 2) return IK_TOO_SHORT; // the core rounds half up
    core->bad = 0;
    return IK_OK;
}

static void put_target(uint32_t *record, const lists *of, size_t k, int exponent) {
    const ik_hand t = target_of(of, k);
    record[0] = length_word(t.x, exponent);
    record[1] = length_word(t.y, exponent);
    record[2] = length_word(t.z, exponent);
    record[3] = (uint32_t)rounded(t.phi / TURN, 32);
    record[4] = length_word(t.d1, exponent);
    record[5] = length_word(t.d2, exponent);
    record[6] = of->hands ? length_word(t.tool, exponent) : t.tag;
    record[7] = of->hands ? (uint32_t)t.branch << 24 | (t.tag & 0xffffffu) : 0;
    for (size_t i = 8; i < words_of(of); i++) record[i] = i < 12 ? length_word(t.hand[i - 8], 0) : 0;
}

static void take_result(const lists *of, size_t k, const uint32_t *record) {
    ik_joints r;
    for (int i = 0; of->hands && i < 7; i++) r.th[i] = angle_of(*record++);
    const uint32_t *qs = of->hands ? record + 1 : record, *tag = of->hands ? record : record + 6;
    for (int i = 0; i < 4; i++) r.qs[i] = value_of(qs[i]);
    for (int i = 0; i < 2; i++) r.qe[i] = value_of(qs[4 + i]);
    r.tag = *tag & 0xffffffu;
    r.flags = (uint8_t)(*tag >> 24);
    if (of->hands) {
        r.over_limit = (uint16_t)qs[7];
        of->joints[k] = r;
    } else {
        of->results[k] = (ik_result){{r.qs[0], r.qs[1], r.qs[2], r.qs[3]}, {r.qe[0], r.qe[1]}, r.tag, r.flags};
    }
}

// ---- a job ----

// Starts a soft reset and waits until pending transfers have ended. Returns code, or IK_TIMEOUT.
static ik_code give_up(ik_core *core, ik_code code) {
    set(core, IK_CONTROL, IK_CONTROL_SOFT_RESET);
    for (uint32_t left = core->bus.polls; get(core, IK_STATUS) & IK_STATUS_BUSY;)
        if (core->bus.polls && !--left) return IK_TIMEOUT;
    return code;
}

static ik_code ended(ik_core *core) {
    const ik_bus *bus = &core->bus;
    for (uint32_t left = bus->polls; !core->events;) {
        if (core->aborted) return give_up(core, IK_ABORTED);
        if (bus->wait) {
            if (!bus->wait(bus->user)) return give_up(core, IK_TIMEOUT);
        } else if (!ik_irq(core) && bus->polls && !--left) {
            return give_up(core, IK_TIMEOUT);
        }
    }
    if (core->events & IK_IRQ_STATUS_REFUSED) return IK_BUSY;
    if (!(core->events & IK_IRQ_STATUS_ERROR)) return IK_OK;
    const uint32_t code = field(get(core, IK_STATUS), IK_STATUS_CODE, IK_STATUS_CODE_SHIFT);
    core->error_address = (uint64_t)get(core, IK_ERROR_HI) << 32 | get(core, IK_ERROR_LO);
    return (ik_code)code;
}

// Runs a job of n targets, from index core->written on, and takes its valid results.
static ik_code run(ik_core *core, const lists *of, uint32_t n, int exponent) {
    const ik_bus *bus = &core->bus;
    const size_t words = words_of(of), index = of->hands ? 14 : 7; // index: word in which the core writes k
    const size_t first = core->written;
    const ik_area *from = &bus->source, *to = &bus->destination;
    if (get(core, IK_STATUS) & IK_STATUS_BUSY) return IK_BUSY;
    for (uint32_t k = 0; k < n; k++) {
        put_target(from->at + k * words, of, first + k, exponent);
        to->at[k * words + index] = ~k;
    }
    if (bus->flush) {
        bus->flush(bus->user, from->at, n * words * 4);
        bus->flush(bus->user, to->at, n * words * 4);
    }
    set(core, IK_IRQ_STATUS, IK_IRQ_STATUS_DONE | IK_IRQ_STATUS_ERROR | IK_IRQ_STATUS_REFUSED);
    core->events = 0;
    set(core, IK_COUNT, n);
    set(core, IK_SOURCE_LO, (uint32_t)from->address);
    set(core, IK_SOURCE_HI, (uint32_t)(from->address >> 32));
    set(core, IK_DESTINATION_LO, (uint32_t)to->address);
    set(core, IK_DESTINATION_HI, (uint32_t)(to->address >> 32));
    set(core, IK_CONTROL, IK_CONTROL_START);
    const ik_code code = ended(core);
    if (code == IK_BUSY) return code;
    const uint32_t written = code ? get(core, IK_WRITTEN) : n;
    if (bus->invalidate) bus->invalidate(bus->user, to->at, n * words * 4);
    for (uint32_t k = 0; k < n && k < written; k++, core->written++) {
        if (to->at[k * words + index] != k) return IK_LOST;
        take_result(of, first + k, to->at + k * words);
    }
    return code;
}

// ---- interface ----

ik_code ik_init(ik_core *core, const ik_bus *bus) {
    if (!core) return IK_NULL;
    *core = (ik_core){.width = 0};
    if (!bus || !bus->read || !bus->write || !bus->source.at || !bus->destination.at || !bus->records) return IK_NULL;
    core->bus = *bus;
    const uint32_t id = get(core, IK_ID);
    if (field(id, IK_ID_MAGIC, IK_ID_MAGIC_SHIFT) != IK_ID_MAGIC_RESET) return IK_NO_CORE;
    if (field(id, IK_ID_MAJOR, IK_ID_MAJOR_SHIFT) != IK_ID_MAJOR_RESET) return IK_VERSION;
    const ik_code code = give_up(core, IK_OK);
    if (code) return code;
    const uint32_t all = IK_IRQ_ENABLE_DONE | IK_IRQ_ENABLE_ERROR | IK_IRQ_ENABLE_REFUSED;
    set(core, IK_IRQ_ENABLE, bus->wait ? all : 0);
    const uint32_t config = get(core, IK_CONFIG);
    core->data_width = field(config, IK_CONFIG_DATA_WIDTH, IK_CONFIG_DATA_WIDTH_SHIFT);
    core->addr_width = field(config, IK_CONFIG_ADDR_WIDTH, IK_CONFIG_ADDR_WIDTH_SHIFT);
    core->lean = (config & IK_CONFIG_LEAN) != 0;
    core->arm = (config & IK_CONFIG_ARM) != 0;
    core->latency = field(get(core, IK_PIPELINE), IK_PIPELINE_LATENCY, IK_PIPELINE_LATENCY_SHIFT);
    core->width = field(config, IK_CONFIG_WIDTH, IK_CONFIG_WIDTH_SHIFT);
    return IK_OK;
}

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
        const size_t left = n - core->written;
        const uint32_t part = left < core->bus.records ? (uint32_t)left : core->bus.records;
        code = run(core, of, part, exponent);
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
    uint32_t words[14];
    for (int k = 0; k < 7; k++) {
        const double from = low[k] * unit, to = high[k] * unit;
        core->bad = (size_t)k;
        words[k] = UINT32_C(1) << 31;
        words[k + 7] = words[k] - 1;
        if (!(low[k] <= high[k])) return IK_BAD_LIMITS;
        if (!((double)high[k] - low[k] < TURN)) continue;
        if (!(-most < from && to < most)) return IK_BAD_LIMITS;
        int64_t first = (int64_t)from, last = (int64_t)to; // toward 0
        first += (double)first < from;
        last -= (double)last > to;
        if (first > last) return IK_BAD_LIMITS;
        words[k] = (uint32_t)((uint64_t)first << below);
        words[k + 7] = (uint32_t)((uint64_t)last << below);
    }
    core->bad = 0;
    for (uint32_t k = 0; k < 14; k++) set(core, IK_LIMIT_LOW + 4 * k, words[k]);
    return IK_OK;
}

bool ik_irq(ik_core *core) {
    const uint32_t seen = get(core, IK_IRQ_STATUS);
    if (!seen) return false;
    set(core, IK_IRQ_STATUS, seen);
    core->events |= seen;
    return true;
}

void ik_abort(ik_core *core) {
    core->aborted = true;
}

const char *ik_error_text(ik_code code) {
    static const char *const texts[IK_CODES] = {
        IK_CODE_TEXTS,
        [IK_NULL] = "A pointer is null, or a buffer has no record.",
        [IK_NO_CORE] = "No core answers at this address, or ik_init has not succeeded.",
        [IK_VERSION] = "The core has another register map.",
        [IK_NO_TARGETS] = "There are no targets.",
        [IK_NOT_FINITE] = "A target is not finite.",
        [IK_NOT_AN_ARM] = "An arm length is not positive.",
        [IK_TOO_FAR_OUT] = "A target is too far out for the longest arm, or an arm is beyond double.",
        [IK_TOO_SHORT] = "An arm length is too short compared with the longest arm.",
        [IK_NOT_A_HAND] = "A hand's quaternion is not of length 1.",
        [IK_OTHER_CORE] = "The core solves targets of wrists, or only hand poses: ARM.",
        [IK_BAD_LIMITS] = "No angle is within the limits of a joint.",
        [IK_BUSY] = "Another job runs.",
        [IK_TIMEOUT] = "The job did not end in time.",
        [IK_ABORTED] = "The job was aborted.",
        [IK_LOST] = "A result is not where the CPU looks: bus address of a buffer, cache.",
    };
    return code >= 0 && code < IK_CODES && texts[code] ? texts[code] : "A code that the driver does not know.";
}
