// SPDX-License-Identifier: Apache-2.0
// Driver of ik_axi, the memory-to-memory core. C99; no allocation, no libm, only freestanding headers.
// Files: ik.h, the generated ik_regs.h, ik_words.c (jobs in the core's words; no floating point) and ik.c (calls in
// floating point, for which ik_words.c does the jobs). See docs/integration.md for an example.
#ifndef IK_H
#define IK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ik_regs.h"

// Type of numbers. A double holds every bit of a word; -DIK_REAL=float selects float, common in animation. Words are
// built by integer shifts. Double arithmetic is a division, a sum and a few comparisons per target, and a division or
// product and a sum per value of a result.
#ifndef IK_REAL
#define IK_REAL double
#endif
typedef IK_REAL ik_real;

// Wrist target. Lengths are in any unit, the same for all targets of a call. phi is in radians, of any magnitude.
typedef struct {
    ik_real x, y, z, phi, d1, d2;
    uint32_t tag; // the low 24 bits are returned
} ik_target;

typedef struct {
    ik_real qs[4]; // shoulder: w, i, j, k
    ik_real qe[2]; // elbow: w, i; its j and k are 0
    uint32_t tag;
    uint8_t flags; // see docs/core.md
} ik_result;

// Hand pose, for a core with ARM = 1. x, y, z is the hand's point; the wrist is `tool` behind it on the hand's z axis.
typedef struct {
    ik_real x, y, z, phi, d1, d2, tool;
    ik_real hand[4]; // orientation: w, i, j, k of a unit quaternion
    uint32_t tag;    // the low 24 bits are returned
    uint8_t branch;  // a set bit selects the other solution: bit 0 shoulder, 1 elbow, 2 wrist
} ik_hand;

typedef struct {
    ik_real th[7]; // joint angles in radians, -pi to pi
    ik_real qs[4], qe[2];
    uint32_t tag;
    uint8_t flags;
    uint16_t over_limit; // bit k: th[k] is outside its limits; bit 8: |hand| is outside [1 - 2^-8, 1 + 2^-8)
} ik_joints;

// Records: the core's words as they stand in memory. A length is Q2.30 in any unit, with d1 + d2 below 2; quaternions
// are Q2.30; one turn is 2^32. The core rounds half up to its word length.
typedef struct {
    int32_t x, y, z;
    uint32_t phi; // wraps
    int32_t d1, d2;
    uint32_t tag; // the low 24 bits are returned
    uint32_t unused;
} ik_target_words;

typedef struct {
    int32_t qs[4]; // shoulder: w, i, j, k
    int32_t qe[2]; // elbow: w, i
    uint32_t tag;  // flags << 24 | tag
    uint32_t index;
} ik_result_words;

typedef struct {
    int32_t x, y, z;
    uint32_t phi;
    int32_t d1, d2, tool;
    uint32_t tag; // branch << 24 | tag
    int32_t hand[4];
    uint32_t unused[4];
} ik_hand_words;

typedef struct {
    int32_t th[7];
    uint32_t tag; // flags << 24 | tag
    int32_t qs[4], qe[2];
    uint32_t index;
    uint32_t over_limit; // as in ik_joints
} ik_joints_words;

// IK_OK, a hardware code IK_CODE_* of ik_regs.h, or one of these codes of the driver.
typedef int ik_code;
enum {
    IK_OK = IK_CODE_NONE,
    // The call was invalid; no job was started.
    IK_NULL = 16,   // a null pointer, or buffers of 0 records
    IK_NO_CORE,     // ID does not match, or ik_init has not succeeded
    IK_VERSION,     // another major version
    IK_NO_TARGETS,  // n is 0
    IK_TOO_MANY,    // ik_solve_words, ik_solve_arm_words: n is above ik_bus.records
    IK_NOT_FINITE,  // infinite or NaN; for this and the next four codes, ik_core.bad is the target
    IK_NOT_AN_ARM,  // d1 or d2 is not positive
    IK_TOO_FAR_OUT, // a coordinate or tool, for the longest reach; or d1 + d2 overflows a double
    IK_TOO_SHORT,   // the scaled word of d1 or d2 is 0
    IK_NOT_A_HAND,  // a component of the quaternion is outside [-2, 2)
    IK_OTHER_CORE,  // a call for wrist targets on a core with ARM = 1, or one for hand poses on any other core
    IK_BAD_LIMITS,  // low is above high, or no angle of the core is between them; ik_core.bad is the joint, from 0
    // The job did not run, or it failed.
    IK_BUSY,    // another job is running
    IK_TIMEOUT, // bus.wait returned false or bus.polls ran out; the job was aborted
    IK_ABORTED, // ik_abort was called
    IK_LOST,    // a result is missing from the destination buffer
    IK_CODES
};

// Buffer shared by CPU and core. A record has 32 bytes, or 64 with ARM = 1. The address must be a multiple of the
// record size. With a cache, `at` and the size of the buffer must be multiples of the cache line size.
typedef struct {
    uint32_t *at;     // CPU pointer
    uint64_t address; // bus address
} ik_area;

// Platform interface.
typedef struct {
    void *user; // passed to all callbacks

    // Register access. Each call is a memory barrier for compiler and CPU.
    uint32_t (*read)(void *user, uint32_t offset);
    void (*write)(void *user, uint32_t offset, uint32_t value);

    ik_area source, destination;
    uint32_t records; // capacity of each area; more targets are split into several jobs

    // Write back and invalidate the cache; null if memory is coherent.
    void (*flush)(void *user, const void *at, size_t bytes);
    void (*invalidate)(void *user, void *at, size_t bytes);

    // Null: polling. Otherwise sleeps until ik_irq has run since the last return; may return early. False: timeout.
    bool (*wait)(void *user);
    uint32_t polls; // maximum consecutive reads of a polled register; 0: unlimited
} ik_bus;

typedef struct {
    ik_bus bus;
    uint32_t width, data_width, addr_width, latency; // parameters W, DATA_W, ADDR_W; latency in clocks
    bool lean;                                       // true: lean equations; false: the paper's
    bool arm;                                        // ARM = 1: the core solves hand poses
    bool fold;                                       // folded onto one multiplier

    // outcome of the last call that solved
    size_t written;         // number of valid results, counted from the first, with any return code
    size_t bad;             // index of the rejected target, or joint
    uint64_t error_address; // of a hardware error; see ERROR in docs/generated/registers.md

    volatile uint32_t events; // IRQ_STATUS bits collected by ik_irq
    volatile bool aborted;
} ik_core;

// Checks the core's ID and version, aborts any running job and reads the parameters. bus is copied.
ik_code ik_init(ik_core *core, const ik_bus *bus);

// ---- in the core's words: no floating point, no copy ----

// Buffers of the records. Fill targets or hands, solve, and read results or joints.
static inline ik_target_words *ik_target_records(const ik_core *core) {
    return (ik_target_words *)(void *)core->bus.source.at;
}
static inline ik_result_words *ik_result_records(const ik_core *core) {
    return (ik_result_words *)(void *)core->bus.destination.at;
}
static inline ik_hand_words *ik_hand_records(const ik_core *core) {
    return (ik_hand_words *)(void *)core->bus.source.at;
}
static inline ik_joints_words *ik_joints_records(const ik_core *core) {
    return (ik_joints_words *)(void *)core->bus.destination.at;
}

// Solves the first n records of ik_target_records, or of ik_hand_records on a core with ARM = 1. The first core->written
// records of ik_result_records, or ik_joints_records, are valid. The words are not checked: the core flags a bad length or
// quaternion.
ik_code ik_solve_words(ik_core *core, size_t n);
ik_code ik_solve_arm_words(ik_core *core, size_t n);

// Sets the limits of th1 .. th7 in words; a low word above the high one leaves the arc across half a turn. No job may
// be running.
ik_code ik_limits_words(ik_core *core, const uint32_t low[7], const uint32_t high[7]);

// True while a job is running, also another host's. Do not write to the buffers then.
bool ik_busy(const ik_core *core);

// ---- in floating point ----

// Solves n targets. All lengths are scaled by a common power of two, as in make run.
ik_code ik_solve(ik_core *core, const ik_target *targets, ik_result *results, size_t n);

// Solves n hand poses on a core with ARM = 1, otherwise like ik_solve.
ik_code ik_solve_arm(ik_core *core, const ik_hand *hands, ik_joints *results, size_t n);

// Sets the limits of th1 .. th7 in radians, rounded inward; a whole turn or more is no limit. No job may be running.
ik_code ik_limits(ik_core *core, const ik_real low[7], const ik_real high[7]);

// Call it in the interrupt handler, then wake bus.wait. Returns false if the interrupt has another source.
bool ik_irq(ik_core *core);

// Aborts a running call from another context. If bus.wait is set, wake it afterwards.
void ik_abort(ik_core *core);

const char *ik_error_text(ik_code code);

// Private to the driver: runs a job of n records and adds its valid results to core->written.
ik_code ik_job(ik_core *core, size_t n);

#endif
