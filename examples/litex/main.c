// SPDX-License-Identifier: Apache-2.0
// Solves the targets of targets.h on a LiteX SoC: by ik_axi with polling and with its interrupt, and by the lean
// equations on the CPU. Compares every word of the core with the model's, and prints clocks. All addresses are from the
// SoC's headers.
#include <generated/csr.h>
#include <generated/mem.h>
#include <generated/soc.h>
#include <irq.h>

#include "ik.h"
#include "targets.h"

enum { RECORDS = MAIN_RAM_SIZE / 2 / 32, PATIENCE = 100000 }; // of each area; turns of a waiting loop

static ik_core core;
static ik_result results[TARGETS];
static volatile unsigned interrupts;
static unsigned seen;

// ---- printing ----

static void put(const char *text) {
    for (; *text; text++) {
        while (uart_txfull_read()) {}
        uart_rxtx_write((uint32_t)*text);
    }
}

static void put_number(uint32_t value) {
    char digits[11], *at = digits + 10;
    *at = 0;
    do *--at = (char)('0' + value % 10);
    while (value /= 10);
    put(at);
}

static uint32_t clocks(void) {
    timer0_uptime_latch_write(1);
    return (uint32_t)timer0_uptime_cycles_read();
}

static void report(const char *what, uint32_t count) {
    put(what);
    put_number(count);
    put(" clocks\n");
}

// ---- platform of the driver ----

static uint32_t reads(void *user, uint32_t offset) {
    (void)user;
    return *(volatile uint32_t *)(IK_BASE + offset);
}

static void writes(void *user, uint32_t offset, uint32_t value) {
    (void)user;
    __asm__ volatile("fence" ::: "memory"); // records before START
    *(volatile uint32_t *)(IK_BASE + offset) = value;
}

static void invalidate(void *user, void *at, size_t bytes) {
    (void)user, (void)at, (void)bytes;
    flush_cpu_dcache(); // of VexRiscv: written through, invalidated as a whole
}

void isr(void) {
    if (irq_pending() & irq_getmask() & 1u << IK_INTERRUPT && ik_irq(&core)) interrupts++;
}

static bool sleeps(void *user) {
    (void)user;
    for (uint32_t left = PATIENCE; interrupts == seen; left--)
        if (!left) return false;
    seen = interrupts;
    return true;
}

// ---- tests ----

static double value(const ik_result *r, int i) {
    const double all[6] = {r->qs[0], r->qs[1], r->qs[2], r->qs[3], r->qe[0], r->qe[1]};
    return all[i];
}

// Solves all targets and compares the words in memory and the driver's values. Returns the number of wrong targets.
static unsigned solve(const char *name, bool interrupt) {
    uint32_t *const ram = (uint32_t *)MAIN_RAM_BASE;
    const ik_bus bus = {
        .read = reads,
        .write = writes,
        .source = {ram, MAIN_RAM_BASE},
        .destination = {ram + RECORDS * 8, MAIN_RAM_BASE + RECORDS * 32},
        .records = RECORDS,
        .invalidate = invalidate,
        .wait = interrupt ? sleeps : 0,
        .polls = PATIENCE,
    };
    ik_code code = ik_init(&core, &bus);
    const unsigned before = interrupts;
    const uint32_t since = clocks();
    if (!code) code = ik_solve(&core, targets, results, TARGETS);
    const uint32_t took = clocks() - since;
    put(name);
    if (code) {
        put(ik_error_text(code));
        put("\n");
        return TARGETS;
    }
    unsigned wrong = 0;
    for (uint32_t k = 0; k < TARGETS; k++) {
        const uint32_t *word = expected[k];
        const ik_result *r = &results[k];
        bool same = r->tag == (word[6] & 0xffffff) && r->flags == word[6] >> 24;
        for (int i = 0; i < 8; i++) same &= bus.destination.at[k * 8 + i] == word[i];
        for (int i = 0; i < 6; i++) same &= value(r, i) * (1 << 30) == (int32_t)word[i];
        wrong += !same;
    }
    put_number(wrong);
    put(" of ");
    put_number(TARGETS);
    put(" targets differ from the model; interrupts: ");
    put_number(interrupts - before);
    put("\n");
    report("  driver and core  ", took);
    report("  core             ", reads(0, IK_CLOCKS));
    if ((interrupts != before) != interrupt) {
        put("the interrupt does not do what it should\n");
        return TARGETS;
    }
    return wrong;
}

void batch_double(long, long, const double *, const double *, const double *, const double *, const double *,
                  const double *, double *, double *, double *, double *, double *, double *);
void batch_float(long, long, const float *, const float *, const float *, const float *, const float *, const float *,
                 float *, float *, float *, float *, float *, float *);

// Solves all targets on the CPU. Returns the number of targets further than `bar` from the core's.
#define ON_CPU(REAL, BAR)                                                                                              \
    static unsigned on_cpu_##REAL(void) {                                                                              \
        uint32_t took = 0;                                                                                             \
        unsigned wrong = 0;                                                                                            \
        for (uint32_t k = 0; k < TARGETS; k++) {                                                                       \
            const ik_target *t = &targets[k];                                                                          \
            const REAL in[6] = {t->x, t->y, t->z, t->phi, t->d1, t->d2};                                               \
            REAL q[6];                                                                                                 \
            const uint32_t since = clocks();                                                                           \
            batch_##REAL(1, 1, in, in + 1, in + 2, in + 3, in + 4, in + 5, q, q + 1, q + 2, q + 3, q + 4, q + 5);      \
            took += clocks() - since;                                                                                  \
            for (int i = 0; i < 6; i++) {                                                                              \
                const double far = q[i] - value(&results[k], i);                                                       \
                if (!(far < BAR && far > -BAR)) wrong |= 1;                                                            \
            }                                                                                                          \
        }                                                                                                              \
        report("the same equations in C, " #REAL ": ", took);                                                          \
        return wrong;                                                                                                  \
    }
ON_CPU(double, 1e-3)
ON_CPU(float, 1e-3)

int main(void) {
    irq_setmask(1u << IK_INTERRUPT);
    irq_setie(1);
    ik_ev_enable_write(1);
    unsigned wrong = solve("polling: ", false);
    wrong += solve("interrupt: ", true);
    wrong += on_cpu_float();
    wrong += on_cpu_double();
    put(wrong ? "failed\n" : "passed\n");
    while (!uart_txempty_read()) {}
    sim_finish_finish_write(1);
    for (;;) {}
}
