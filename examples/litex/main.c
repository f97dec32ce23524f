// SPDX-License-Identifier: Apache-2.0
// Solves the targets of targets.h on a LiteX SoC: by ik_axi with polling, with its interrupt and in words, and wrist
// targets by the lean equations on the CPU. Compares every word of the core with the model's, and prints clocks. All
// addresses are from the SoC's headers.
#include <generated/csr.h>
#include <generated/mem.h>
#include <generated/soc.h>
#include <irq.h>

#include "ik.h"
#include "targets.h"

#if ARM
typedef ik_joints result;
typedef ik_joints_words result_words;
#define SOLVE ik_solve_arm
#define SOLVE_WORDS ik_solve_arm_words
#else
typedef ik_result result;
typedef ik_result_words result_words;
#define SOLVE ik_solve
#define SOLVE_WORDS ik_solve_words
#endif

enum { WORDS = sizeof(result_words) / 4 };                                     // of a record
enum { RECORDS = MAIN_RAM_SIZE / 2 / sizeof(result_words), PATIENCE = 100000 }; // of a buffer; turns of a waiting loop
enum how { POLLING, INTERRUPT, IN_WORDS };

static ik_core core;
static result results[TARGETS];
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

static bool same_values(const result *r, const result_words *words) {
    bool same = r->tag == (words->tag & 0xffffff) && r->flags == words->tag >> 24;
    for (int i = 0; i < 4; i++) same &= r->qs[i] * (1 << 30) == words->qs[i];
    for (int i = 0; i < 2; i++) same &= r->qe[i] * (1 << 30) == words->qe[i];
#if ARM
    for (int i = 0; i < 7; i++) same &= r->th[i] == words->th[i] * (6.283185307179586 / 4294967296.0);
    same &= r->over_limit == words->over_limit;
#endif
    return same;
}

// Solves all targets, and compares the words in memory, and the driver's values unless it solves in words. Returns the
// number of wrong targets.
static unsigned solve(const char *name, enum how how) {
    uint32_t *const ram = (uint32_t *)MAIN_RAM_BASE;
    const ik_bus bus = {
        .read = reads,
        .write = writes,
        .source = {ram, MAIN_RAM_BASE},
        .destination = {ram + RECORDS * WORDS, MAIN_RAM_BASE + RECORDS * WORDS * 4},
        .records = RECORDS,
        .invalidate = invalidate,
        .wait = how == INTERRUPT ? sleeps : 0,
        .polls = PATIENCE,
    };
    ik_code code = ik_init(&core, &bus);
    const unsigned before = interrupts;
    for (uint32_t k = 0; how == IN_WORDS && k < TARGETS; k++)
        for (int i = 0; i < WORDS; i++) bus.source.at[k * WORDS + i] = records[k][i];
    const uint32_t since = clocks();
    if (!code) code = how == IN_WORDS ? SOLVE_WORDS(&core, TARGETS) : SOLVE(&core, targets, results, TARGETS);
    const uint32_t took = clocks() - since;
    put(name);
    if (code) {
        put(ik_error_text(code));
        put("\n");
        return TARGETS;
    }
    unsigned wrong = 0;
    for (uint32_t k = 0; k < TARGETS; k++) {
        bool same = how == IN_WORDS || same_values(&results[k], (const result_words *)expected[k]);
        for (int i = 0; i < WORDS; i++) same &= bus.destination.at[k * WORDS + i] == expected[k][i];
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
    if ((interrupts != before) != (how == INTERRUPT)) {
        put("the interrupt does not do what it should\n");
        return TARGETS;
    }
    return wrong;
}

#if !ARM
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
                const double far = q[i] - (i < 4 ? results[k].qs[i] : results[k].qe[i - 4]);                           \
                if (!(far < BAR && far > -BAR)) wrong |= 1;                                                            \
            }                                                                                                          \
        }                                                                                                              \
        report("the same equations in C, " #REAL ": ", took);                                                          \
        return wrong;                                                                                                  \
    }
ON_CPU(double, 1e-3)
ON_CPU(float, 1e-3)
#endif

int main(void) {
    irq_setmask(1u << IK_INTERRUPT);
    irq_setie(1);
    ik_ev_enable_write(1);
    unsigned wrong = solve("double, polling: ", POLLING);
    wrong += solve("double, interrupt: ", INTERRUPT);
    wrong += solve("words, polling: ", IN_WORDS);
#if !ARM
    wrong += on_cpu_float();
    wrong += on_cpu_double();
#endif
    put(wrong ? "failed\n" : "passed\n");
    while (!uart_txempty_read()) {}
    sim_finish_finish_write(1);
    for (;;) {}
}
