// SPDX-License-Identifier: Apache-2.0
// ik_axi behind /dev/uioN of Linux: a bus for ik.h, by the system calls of ik_uio.c.
#ifndef IK_UIO_H
#define IK_UIO_H

#include "ik.h"

// The uio device has two maps, with uio_pdrv_genirq two entries of `reg`: 0 the registers, 1 memory that Linux leaves to
// the core (reserved-memory, no-map), half for targets, half for results. Linux maps both uncached.
// On Arm, compile ik.c with -mstrict-align (64 bits) or -mno-unaligned-access, which such a mapping needs.
typedef struct {
    ik_core core;
    ik_bus bus;   // for ik_init(&uio.core, &uio.bus)
    int patience; // ms until the wait for an interrupt ends with IK_TIMEOUT; -1: never
    int error;    // errno of a failed wait when ik_solve returns IK_TIMEOUT; 0: no interrupt came
    int file;     // from here on for ik_uio.c
    volatile uint32_t *registers;
    void *pages[2];
    size_t bytes[2];
} ik_uio;

// device: "/dev/uio0", maps: "/sys/class/uio/uio0/maps". Returns IK_OK, or -errno with everything closed; EINVAL: sysfs
// does not describe a map, or the buffer is too small or not aligned to 32. Do not move uio before it is closed.
ik_code ik_uio_open(ik_uio *uio, const char *device, const char *maps, int patience);
void ik_uio_close(ik_uio *uio);

#endif
