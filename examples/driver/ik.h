// SPDX-License-Identifier: Apache-2.0
// Driver of ik_axi, the core from memory to memory. C99; no allocation, no libm, of libc the freestanding headers.
// Two files, ik.h and ik.c, beside the generated ik_regs.h. docs/integration.md has an example.
#ifndef IK_H
#define IK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ik_regs.h"

// A double holds every bit of a word; a float, with -DIK_REAL=float, is what animation has. Words are made by shifting
// the bits of a double; arithmetic in double is a division, a sum and a few comparisons for a target, a division and a
// sum for each value of a result.
#ifndef IK_REAL
#define IK_REAL double
#endif
typedef IK_REAL ik_real;

// Lengths in any unit, one for all targets of a call. phi in radians, of any size.
typedef struct {
    ik_real x, y, z, phi, d1, d2;
    uint32_t tag; // its low 24 bits come back
} ik_target;

typedef struct {
    ik_real qs[4]; // shoulder: w, i, j, k
    ik_real qe[2]; // elbow: w, i; its j and k are 0
    uint32_t tag;
    uint8_t flags; // as docs/core.md says
} ik_result;

// 0, what the hardware says, IK_CODE_* of ik_regs.h, or what the driver says.
typedef int ik_code;
enum {
    IK_OK = IK_CODE_NONE,
    // wrong calls; nothing was started
    IK_NULL = 16,   // a null pointer, or buffers of 0 records
    IK_NO_CORE,     // ID is not that of a core, or ik_init has not succeeded
    IK_VERSION,     // another major version
    IK_NO_TARGETS,  // n is 0
    IK_NOT_FINITE,  // this and the next three: ik_core.bad is the target
    IK_NOT_AN_ARM,  // d1 or d2 is not positive
    IK_TOO_FAR_OUT, // beside the longest arm; or the arm is beyond double
    IK_TOO_SHORT,   // beside the longest arm a word of d1 or d2 is 0
    // ends of a job
    IK_BUSY,    // another job runs
    IK_TIMEOUT, // bus.wait gave up or bus.polls are used up; the job was aborted
    IK_ABORTED, // by ik_abort
    IK_LOST,    // a result is not where the CPU looks
    IK_CODES
};

// Memory that both sides see, 32 bytes a record. The core asks for an address that is a multiple of 32; with a cache,
// at and size are multiples of its lines.
typedef struct {
    uint32_t *at;     // for the CPU
    uint64_t address; // for the core
} ik_area;

// What the platform provides.
typedef struct {
    void *user; // handed to all of these

    // Registers. Either is a memory barrier, for compiler and CPU.
    uint32_t (*read)(void *user, uint32_t offset);
    void (*write)(void *user, uint32_t offset, uint32_t value);

    ik_area source, destination;
    uint32_t records; // in each area; more targets become several jobs

    // May be null, where memory is coherent: write the cache back; forget what is in it.
    void (*flush)(void *user, const void *at, size_t bytes);
    void (*invalidate)(void *user, void *at, size_t bytes);

    // Null: polling. Else: sleeps until ik_irq has run since its last return, and may return earlier; false: gives up.
    bool (*wait)(void *user);
    uint32_t polls; // most reads in a row of a register that the driver waits for; 0: any number
} ik_bus;

typedef struct {
    ik_bus bus;
    uint32_t width, data_width, addr_width, latency; // of this instance: W, DATA_W, ADDR_W, clocks
    bool lean;                                       // datapath: lean, or the paper's

    // of the last ik_solve
    size_t written;         // so many results, from the first on, are good, whatever the code
    size_t bad;             // target that was not accepted
    uint64_t error_address; // for an error of the hardware; what it is of: ERROR in docs/generated/registers.md

    volatile uint32_t events; // bits of IRQ_STATUS that ik_irq has seen
    volatile bool aborted;
} ik_core;

// Checks that a core of this version answers, ends whatever it does and reads its parameters. bus is copied.
ik_code ik_init(ik_core *core, const ik_bus *bus);

// Solves n targets. All lengths are scaled by one power of two, as make run does.
ik_code ik_solve(ik_core *core, const ik_target *targets, ik_result *results, size_t n);

// For the interrupt's handler, which then wakes bus.wait. False: the interrupt was another's.
bool ik_irq(ik_core *core);

// Ends an ik_solve from elsewhere; with bus.wait, wake it afterwards.
void ik_abort(ik_core *core);

const char *ik_error_text(ik_code code);

#endif
