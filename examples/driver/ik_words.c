// Jobs in the core's words. No floating point.
// SPDX-License-Identifier: Apache-2.0
#include "ik.h"

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "records are little endian"
#endif
typedef char ik_records_have_32_or_64_bytes[sizeof(ik_target_words) == 32 && sizeof(ik_result_words) == 32 &&
                                                    sizeof(ik_hand_words) == 64 && sizeof(ik_joints_words) == 64
                                                ? 1
                                                : -1];

static uint32_t get(const ik_core *core, uint32_t offset) {
    return core->bus.read(core->bus.user, offset);
}

static void set(const ik_core *core, uint32_t offset, uint32_t value) {
    core->bus.write(core->bus.user, offset, value);
}

static uint32_t field(uint32_t value, uint32_t mask, unsigned shift) {
    return (value & mask) >> shift;
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

// Returns the word into which the core writes record k's index.
static uint32_t *index_of(const ik_core *core, size_t k) {
    return core->arm ? &ik_joints_records(core)[k].index : &ik_result_records(core)[k].index;
}

ik_code ik_job(ik_core *core, size_t n) {
    const ik_bus *bus = &core->bus;
    const ik_area *from = &bus->source, *to = &bus->destination;
    const size_t bytes = n * (core->arm ? sizeof(ik_hand_words) : sizeof(ik_target_words));
    if (ik_busy(core)) return IK_BUSY;
    for (size_t k = 0; k < n; k++) *index_of(core, k) = ~(uint32_t)k;
    if (bus->flush) {
        bus->flush(bus->user, from->at, bytes);
        bus->flush(bus->user, to->at, bytes);
    }
    set(core, IK_IRQ_STATUS, IK_IRQ_STATUS_DONE | IK_IRQ_STATUS_ERROR | IK_IRQ_STATUS_REFUSED);
    core->events = 0;
    set(core, IK_COUNT, (uint32_t)n);
    set(core, IK_SOURCE_LO, (uint32_t)from->address);
    set(core, IK_SOURCE_HI, (uint32_t)(from->address >> 32));
    set(core, IK_DESTINATION_LO, (uint32_t)to->address);
    set(core, IK_DESTINATION_HI, (uint32_t)(to->address >> 32));
    set(core, IK_CONTROL, IK_CONTROL_START);
    const ik_code code = ended(core);
    if (code == IK_BUSY) return code;
    const size_t written = code ? get(core, IK_WRITTEN) : n;
    if (bus->invalidate) bus->invalidate(bus->user, to->at, bytes);
    for (size_t k = 0; k < n && k < written; k++, core->written++)
        if (*index_of(core, k) != k) return IK_LOST;
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
    core->fold = (config & IK_CONFIG_FOLD) != 0;
    core->latency = field(get(core, IK_PIPELINE), IK_PIPELINE_LATENCY, IK_PIPELINE_LATENCY_SHIFT);
    core->width = field(config, IK_CONFIG_WIDTH, IK_CONFIG_WIDTH_SHIFT);
    return IK_OK;
}

// Solves the n records in the buffer, of a core for wrists or for hand poses.
static ik_code solve(ik_core *core, bool arm, size_t n) {
    if (!core) return IK_NULL;
    if (!core->width) return IK_NO_CORE;
    if (core->arm != arm) return IK_OTHER_CORE;
    core->written = core->bad = 0;
    core->error_address = 0;
    core->aborted = false;
    if (!n) return IK_NO_TARGETS;
    if (n > core->bus.records) return IK_TOO_MANY;
    return ik_job(core, n);
}

ik_code ik_solve_words(ik_core *core, size_t n) {
    return solve(core, false, n);
}

ik_code ik_solve_arm_words(ik_core *core, size_t n) {
    return solve(core, true, n);
}

ik_code ik_limits_words(ik_core *core, const uint32_t low[7], const uint32_t high[7]) {
    if (!core || !low || !high) return IK_NULL;
    if (!core->width) return IK_NO_CORE;
    if (!core->arm) return IK_OTHER_CORE;
    for (uint32_t k = 0; k < 7; k++) {
        set(core, IK_LIMIT_LOW + 4 * k, low[k]);
        set(core, IK_LIMIT_HIGH + 4 * k, high[k]);
    }
    return IK_OK;
}

bool ik_busy(const ik_core *core) {
    return (get(core, IK_STATUS) & IK_STATUS_BUSY) != 0;
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
        [IK_TOO_MANY] = "There are more targets than records in a buffer.",
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
