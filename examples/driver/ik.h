// SPDX-License-Identifier: Apache-2.0
// Driver of ik_axi, the memory-to-memory core. C99; no allocation, no libm, only freestanding headers.
// Files: ik.h, ik.c and the generated ik_regs.h. See docs/integration.md for an example.
#ifndef IK_H
#define IK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ik_regs.h"

// A double holds every bit of a word; -DIK_REAL=float selects float, common in animation. Words are built by shifting
// the bits of a double. Double arithmetic: a division, a sum and a few comparisons per target, a division and a sum per
// value of a result.
#ifndef IK_REAL
#define IK_REAL double
#endif
typedef IK_REAL ik_real;

// Lengths in any unit, the same for all targets of a call. phi in radians, any magnitude.
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

// A hand pose, for a core with ARM = 1. x, y, z is the hand's point; the wrist is `tool` behind it on the hand's z axis.
typedef struct {
    ik_real x, y, z, phi, d1, d2, tool;
    ik_real hand[4]; // orientation: w, i, j, k of a unit quaternion
    uint32_t tag;    // the low 24 bits are returned
    uint8_t branch;  // bit 0 shoulder, 1 elbow, 2 wrist: the other solution there
} ik_hand;

typedef struct {
    ik_real th[7]; // joint angles in radians, -pi to pi
    ik_real qs[4], qe[2];
    uint32_t tag;
    uint8_t flags;
    uint16_t over_limit; // bit k: th[k] is outside its limits; bit 8: length of the quaternion outside [1 - 2^-8, 1 + 2^-8)
} ik_joints;

// 0, a hardware code IK_CODE_* of ik_regs.h, or a driver code.
typedef int ik_code;
enum {
    IK_OK = IK_CODE_NONE,
    // invalid calls; no job was started
    IK_NULL = 16,   // a null pointer, or buffers of 0 records
    IK_NO_CORE,     // ID does not match, or ik_init has not succeeded
    IK_VERSION,     // another major version
    IK_NO_TARGETS,  // n is 0
    IK_NOT_FINITE,  // here and in the next three, ik_core.bad is the target
    IK_NOT_AN_ARM,  // d1 or d2 is not positive
    IK_TOO_FAR_OUT, // for the longest arm, or the reach overflows a double
    IK_TOO_SHORT,   // the scaled word of d1 or d2 is 0
    IK_NOT_A_HAND,  // a part of the quaternion is outside [-2, 2); ik_core.bad is the target
    IK_OTHER_CORE,  // ik_solve with ARM = 1, ik_solve_arm or ik_limits without it
    IK_BAD_LIMITS,  // low is not below high, or no angle of the core is between them; ik_core.bad is the joint, from 0
    // job results
    IK_BUSY,    // another job is running
    IK_TIMEOUT, // bus.wait returned false or bus.polls ran out; the job was aborted
    IK_ABORTED, // by ik_abort
    IK_LOST,    // a result is missing from the destination buffer
    IK_CODES
};

// Memory shared by CPU and core, 32 bytes per record, with ARM = 1 64. The address must be a multiple of that; with a
// cache, `at` and the size must be multiples of its line size.
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

    // Null: polling. Otherwise sleeps until ik_irq has run since its last return; may return early. False: timeout.
    bool (*wait)(void *user);
    uint32_t polls; // maximum consecutive reads of a polled register; 0: unlimited
} ik_bus;

typedef struct {
    ik_bus bus;
    uint32_t width, data_width, addr_width, latency; // of this instance: W, DATA_W, ADDR_W, latency in clocks
    bool lean;                                       // datapath: lean, or the paper's
    bool arm;                                        // ARM = 1: it solves hand poses

    // of the last ik_solve
    size_t written;         // number of valid results, from the first, whatever the code
    size_t bad;             // index of the rejected target
    uint64_t error_address; // of a hardware error; see ERROR in docs/generated/registers.md

    volatile uint32_t events; // IRQ_STATUS bits collected by ik_irq
    volatile bool aborted;
} ik_core;

// Checks the core's ID and version, aborts any running job and reads the parameters. bus is copied.
ik_code ik_init(ik_core *core, const ik_bus *bus);

// Solves n targets. All lengths are scaled by a common power of two, as in make run.
ik_code ik_solve(ik_core *core, const ik_target *targets, ik_result *results, size_t n);

// The same for hand poses and a core with ARM = 1.
ik_code ik_solve_arm(ik_core *core, const ik_hand *hands, ik_joints *results, size_t n);

// Sets the limits of th1 .. th7 in radians, rounded inward, while no job runs; a whole turn or more is no limit.
ik_code ik_limits(ik_core *core, const ik_real low[7], const ik_real high[7]);

// Called by the interrupt handler, which then wakes bus.wait. False: the interrupt has another source.
bool ik_irq(ik_core *core);

// Aborts a running ik_solve from another context; with bus.wait, wake it afterwards.
void ik_abort(ik_core *core);

const char *ik_error_text(ik_code code);

#endif
