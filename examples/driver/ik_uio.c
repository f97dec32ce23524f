// SPDX-License-Identifier: Apache-2.0
#define _POSIX_C_SOURCE 200809L
#include "ik_uio.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

// Orders accesses to registers and buffer, for the CPU and for the bus.
#if defined(__riscv)
#define BARRIER() __asm__ volatile("fence iorw, iorw" ::: "memory")
#elif defined(__aarch64__) || defined(__ARM_ARCH_7A__)
#define BARRIER() __asm__ volatile("dsb sy" ::: "memory")
#else
#define BARRIER() __sync_synchronize()
#endif

enum { WORD = 4 }; // bytes

static uint32_t load(void *user, uint32_t offset) {
    BARRIER();
    const uint32_t value = ((ik_uio *)user)->registers[offset / WORD];
    BARRIER();
    return value;
}

static void store(void *user, uint32_t offset, uint32_t value) {
    BARRIER();
    ((ik_uio *)user)->registers[offset / WORD] = value;
    BARRIER();
}

// Sets uio->error from `bytes`, the result of a read() or write() of one word. Returns true if the word was moved.
static bool moved(ik_uio *uio, ssize_t bytes) {
    uio->error = bytes == WORD ? 0 : bytes < 0 ? errno : EIO;
    return !uio->error;
}

static bool unmask(ik_uio *uio) {
    const uint32_t on = 1;
    return moved(uio, write(uio->file, &on, WORD));
}

// Waits for an interrupt, which the kernel counts and masks. Then clears it in the core and unmasks it. A signal ends
// the wait early: after ik_abort, send a signal to the thread in ik_solve.
static bool interrupted(void *user) {
    ik_uio *uio = user;
    struct pollfd event = {.fd = uio->file, .events = POLLIN};
    uint32_t count;
    const int ready = poll(&event, 1, uio->patience);
    uio->error = ready < 0 ? errno : 0;
    if (ready <= 0) return uio->error == EINTR;
    if (!moved(uio, read(uio->file, &count, WORD))) return false;
    ik_irq(&uio->core);
    return unmask(uio);
}

// Maps memory `map` of the device. Returns -errno, or IK_OK with pointer and bus address in area, its size in bytes.
static ik_code mapped(ik_uio *uio, const char *maps, int map, ik_area *area, uint64_t *bytes) {
    static const char *const names[] = {"addr", "size", "offset"}; // page's bus address, bytes from it, first used byte
    unsigned long long is[3];
    for (int k = 0; k < 3; k++) {
        char path[256];
        snprintf(path, sizeof path, "%s/map%d/%s", maps, map, names[k]);
        FILE *file = fopen(path, "r");
        if (!file) return -errno;
        const int found = fscanf(file, "%llx", &is[k]);
        fclose(file);
        if (found != 1) return -EINVAL;
    }
    if (is[1] <= is[2] || is[1] > SIZE_MAX || is[2] % WORD) return -EINVAL;
    uio->bytes[map] = (size_t)is[1];
    void *at = mmap(NULL, uio->bytes[map], PROT_READ | PROT_WRITE, MAP_SHARED, uio->file, map * sysconf(_SC_PAGESIZE));
    if (at == MAP_FAILED) return -errno;
    uio->pages[map] = at;
    *area = (ik_area){(uint32_t *)at + is[2] / WORD, is[0] + is[2]};
    *bytes = is[1] - is[2];
    return IK_OK;
}

ik_code ik_uio_open(ik_uio *uio, const char *device, const char *maps, int patience) {
    ik_area registers, from;
    uint64_t bytes = 0;
    *uio = (ik_uio){.patience = patience, .file = open(device, O_RDWR | O_SYNC | O_CLOEXEC)};
    if (uio->file < 0) return -errno;
    ik_code code = mapped(uio, maps, 0, &registers, &bytes);
    if (!code) code = mapped(uio, maps, 1, &from, &bytes);
    const uint64_t size = !code && registers.at[IK_CONFIG / WORD] & IK_CONFIG_ARM ? 64 : 32; // of a record
    const uint64_t records = bytes / size / 2, half = records * size;
    if (!code && (!records || records > UINT32_MAX || from.address % size)) code = -EINVAL;
    if (!code && !unmask(uio)) code = -uio->error;
    if (code) {
        ik_uio_close(uio);
        return code;
    }
    uio->registers = registers.at;
    uio->bus = (ik_bus){uio, load, store, .source = from, .records = (uint32_t)records, .wait = interrupted};
    uio->bus.destination = (ik_area){from.at + half / WORD, from.address + half};
    uio->bus.polls = 1000000;
    return IK_OK;
}

void ik_uio_close(ik_uio *uio) {
    for (int map = 0; map < 2; map++)
        if (uio->pages[map]) munmap(uio->pages[map], uio->bytes[map]);
    if (uio->file >= 0) close(uio->file);
    *uio = (ik_uio){.file = -1};
}
