// SPDX-License-Identifier: Apache-2.0
// ik_axi as uio device /dev/uioN of Linux: an ik_bus for ik.h that uses system calls.
#ifndef IK_UIO_H
#define IK_UIO_H

#include "ik.h"

// The uio device has two maps; with uio_pdrv_genirq, two entries of `reg`. Map 0: registers. Map 1: memory that
// Linux reserves for the core (reserved-memory, no-map), half for targets, half for results. Linux maps both uncached.
// On Arm, such mappings need the driver compiled with -mstrict-align (64 bits) or -mno-unaligned-access (32 bits).
typedef struct {
    ik_core core;
    ik_bus bus;   // for ik_init(&uio.core, &uio.bus)
    int patience; // ms until the wait for an interrupt ends with IK_TIMEOUT; -1: never
    int error;    // errno of a failed wait when ik_solve returns IK_TIMEOUT; 0: no interrupt came
    int file;     // this and all following members are private to ik_uio.c
    volatile uint32_t *registers;
    void *pages[2];
    size_t bytes[2];
} ik_uio;

// device: "/dev/uio0", maps: "/sys/class/uio/uio0/maps". Returns IK_OK, or -errno with everything closed. EINVAL: bad
// map in sysfs, or the buffer is too small or not aligned to a record (32 or 64 bytes). Do not move uio until closed.
ik_code ik_uio_open(ik_uio *uio, const char *device, const char *maps, int patience);
void ik_uio_close(ik_uio *uio);

#endif
