// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.registers` from rtl/axi/ik_axi.rdl; do not edit.
// IK_<REGISTER>: its offset in bytes. IK_<REGISTER>_<FIELD>: mask; .._SHIFT: its lowest bit; .._RESET: what it has to be or is
// after a reset, where that is not 0.
#ifndef IK_REGS_H
#define IK_REGS_H

#define IK_ID 0x00u // Identity
#define IK_ID_MINOR 0x000000ffu
#define IK_ID_MINOR_SHIFT 0
#define IK_ID_MAJOR 0x0000ff00u
#define IK_ID_MAJOR_SHIFT 8
#define IK_ID_MAJOR_RESET 0x1u
#define IK_ID_MAGIC 0xffff0000u
#define IK_ID_MAGIC_SHIFT 16
#define IK_ID_MAGIC_RESET 0x494bu

#define IK_CONFIG 0x04u // Configuration
#define IK_CONFIG_WIDTH 0x000000ffu
#define IK_CONFIG_WIDTH_SHIFT 0
#define IK_CONFIG_DATA_WIDTH 0x0000ff00u
#define IK_CONFIG_DATA_WIDTH_SHIFT 8
#define IK_CONFIG_ADDR_WIDTH 0x00ff0000u
#define IK_CONFIG_ADDR_WIDTH_SHIFT 16
#define IK_CONFIG_LEAN 0x01000000u
#define IK_CONFIG_DIGIT 0x02000000u
#define IK_CONFIG_ARM 0x04000000u
#define IK_CONFIG_FOLD 0x08000000u

#define IK_PIPELINE 0x08u // Pipeline
#define IK_PIPELINE_LATENCY 0x0000ffffu
#define IK_PIPELINE_LATENCY_SHIFT 0
#define IK_PIPELINE_PLACES 0xffff0000u
#define IK_PIPELINE_PLACES_SHIFT 16

#define IK_CONTROL 0x0cu // Control
#define IK_CONTROL_START 0x00000001u
#define IK_CONTROL_SOFT_RESET 0x00000002u

#define IK_STATUS 0x10u // Status
#define IK_STATUS_BUSY 0x00000001u
#define IK_STATUS_DONE 0x00000002u
#define IK_STATUS_ERROR 0x00000004u
#define IK_STATUS_CODE 0x00000f00u
#define IK_STATUS_CODE_SHIFT 8

#define IK_IRQ_ENABLE 0x14u // Interrupt enable
#define IK_IRQ_ENABLE_DONE 0x00000001u
#define IK_IRQ_ENABLE_ERROR 0x00000002u
#define IK_IRQ_ENABLE_REFUSED 0x00000004u

#define IK_IRQ_STATUS 0x18u // Interrupt status
#define IK_IRQ_STATUS_DONE 0x00000001u
#define IK_IRQ_STATUS_ERROR 0x00000002u
#define IK_IRQ_STATUS_REFUSED 0x00000004u

#define IK_COUNT 0x1cu // Count

#define IK_SOURCE_LO 0x20u // Source

#define IK_SOURCE_HI 0x24u // Source, upper half

#define IK_DESTINATION_LO 0x28u // Destination

#define IK_DESTINATION_HI 0x2cu // Destination, upper half

#define IK_ERROR_LO 0x30u // Error address

#define IK_ERROR_HI 0x34u // Error address, upper half

#define IK_WRITTEN 0x38u // Written

#define IK_CLOCKS 0x3cu // Clocks

#define IK_READ_STALLS 0x40u // Read stalls

#define IK_WRITE_STALLS 0x44u // Write stalls

#define IK_LIMIT_LOW 0x48u // Lower limit, the first of 7

#define IK_LIMIT_HIGH 0x64u // Upper limit, the first of 7

// IK_STATUS_CODE
#define IK_CODE_NONE 0
#define IK_CODE_SOURCE_MISALIGNED 1
#define IK_CODE_DESTINATION_MISALIGNED 2
#define IK_CODE_SOURCE_BEYOND 3
#define IK_CODE_DESTINATION_BEYOND 4
#define IK_CODE_OVERLAP 5
#define IK_CODE_READ_SLVERR 6
#define IK_CODE_READ_DECERR 7
#define IK_CODE_WRITE_SLVERR 8
#define IK_CODE_WRITE_DECERR 9

// what they mean, as the beginning of an array
#define IK_CODE_TEXTS \
    [IK_CODE_NONE] = "No error.", \
    [IK_CODE_SOURCE_MISALIGNED] = "The source is not a multiple of the record size.", \
    [IK_CODE_DESTINATION_MISALIGNED] = "The destination is not a multiple of the record size.", \
    [IK_CODE_SOURCE_BEYOND] = "The source ends beyond the address space.", \
    [IK_CODE_DESTINATION_BEYOND] = "The destination ends beyond the address space.", \
    [IK_CODE_OVERLAP] = "The areas overlap.", \
    [IK_CODE_READ_SLVERR] = "SLVERR on a read.", \
    [IK_CODE_READ_DECERR] = "DECERR on a read.", \
    [IK_CODE_WRITE_SLVERR] = "SLVERR on a write.", \
    [IK_CODE_WRITE_DECERR] = "DECERR on a write."

#endif
