# SPDX-License-Identifier: Apache-2.0
"""Monitor of the ``ik_axi`` contract beyond the AXI rules (tb/rules), sampled at every falling edge."""

from __future__ import annotations

from cocotb.triggers import FallingEdge, Timer

BURSTS = 8
"""Maximum number of outstanding bursts in each direction."""

PATIENCE = 20000
"""Clocks without a handshake on any channel after which a test fails."""

OWN = {
    "m_axi_ar": ("addr", "len", "size", "burst", "cache", "prot", "id"),
    "m_axi_aw": ("addr", "len", "size", "burst", "cache", "prot", "id"),
    "m_axi_w": ("strb", "last"),
}
"""Channel -> its monitored payload."""

OTHERS = ("m_axi_r", "m_axi_b", "s_axi_aw", "s_axi_w", "s_axi_ar", "s_axi_b", "s_axi_r")


class Monitor:
    """Collects errors, which a test checks at its end. Counts start at the last reset."""

    def __init__(self, dut, record_beats: int, most_beats: int, places: int) -> None:
        self.dut = dut
        self.record_beats, self.most_beats, self.places = record_beats, most_beats, places
        self.errors: list[str] = []
        self.clock = 0
        self.beats_read: list[int] = []  # clock of each beat of R
        self.bursts_read: list[tuple[int, int]] = []  # address, beats
        self.bursts_written: list[tuple[int, int]] = []
        self.most = {"reads": 0, "writes": 0, "places": 0}
        self.handles = {
            name: [getattr(dut, f"{name}{part}") for part in ("valid", "ready", *OWN.get(name, ()))]
            for name in (*OWN, *OTHERS)
        }
        self.asked_of_axis = dut.u_axis.s_axis_tvalid, dut.u_axis.s_axis_tready
        self._forget()

    def _forget(self) -> None:
        self.reads: list[int] = []  # outstanding beats of each requested burst
        self.writes: list[int] = []  # remaining beats of each burst offered or accepted on AW
        self.unanswered = 0
        self.complete = 0  # bursts whose last beat was sent
        self.asked = self.sent = 0  # beats
        self.moved = self.clock  # clock of the last handshake
        self.failed: dict[str, int] = {}  # address channel -> clock of the first error, after which no burst may start
        self.announced: set[str] = set()  # address channels whose burst has been counted

    def say(self, text: str) -> None:
        self.errors.append(f"clock {self.clock}: {text}")

    async def run(self) -> None:
        await Timer(1, unit="ns")
        while True:
            await FallingEdge(self.dut.clk)
            self.clock += 1
            assert self.clock - self.moved < PATIENCE, f"nothing has moved for {PATIENCE} clocks; {self.errors[:1]}"
            if self.dut.rst.value != 0:
                self._forget()
                continue
            self._look()

    def _look(self) -> None:
        gone = {}
        for name, (valid, ready, *payload) in self.handles.items():
            if valid.value != 1:
                continue
            gone[name] = ready.value == 1
            if name in ("m_axi_ar", "m_axi_aw"):
                if name not in self.announced:
                    self._burst(name, *(int(handle.value) for handle in payload))
                self.announced.discard(name) if gone[name] else self.announced.add(name)
        if any(gone.values()):
            self.moved = self.clock
        if gone.get("m_axi_w"):
            self._write(*(str(handle.value) for handle in self.handles["m_axi_w"][2:]))
        if gone.get("m_axi_r"):
            self._read()
            if self.dut.m_axi_rresp.value != 0:
                self.failed.setdefault("m_axi_ar", self.clock)
        if gone.get("m_axi_b"):
            if self.dut.m_axi_bresp.value != 0:
                self.failed.setdefault("m_axi_aw", self.clock)
                self.failed.setdefault("m_axi_ar", self.clock)
            if not self.complete:
                self.say("B without a whole burst: the memory's error")
            self.complete -= 1
            self.unanswered -= 1
        for name in ("m_axi_r", "m_axi_b"):
            if self.handles[name][1].value != 1:
                self.say(f"{name}ready is low")
        valid, ready = self.asked_of_axis
        if valid.value == 1 and ready.value != 1:
            self.say("a target that ik_axis has no place for")
        if any(gone.values()) or self.announced:
            count = {"reads": len(self.reads), "writes": self.unanswered}
            count["places"] = -(-(self.asked - self.sent) // self.record_beats)
            self.most = {name: max(most, count[name]) for name, most in self.most.items()}

    def _burst(self, name: str, address: int, length: int, size: int, burst: int, cache: int, prot: int, ident: int):
        beats = length + 1
        end = address + (beats << size) - 1
        if self.clock > self.failed.get(name, self.clock) + 1:
            self.say(f"{name}: a burst behind an error")
        if address // 4096 != end // 4096:
            self.say(f"{name}: burst at {address:#x} of {beats} beats crosses 4 KiB")
        if (1 << size) * self.record_beats != 32 or (burst, ident) != (1, 0):
            self.say(f"{name}: size {size} burst {burst} id {ident}")
        if (cache, prot) != (0b0011, 0):
            self.say(f"{name}: cache {cache} prot {prot}")
        if beats > self.most_beats or beats % self.record_beats or address % 32:
            self.say(f"{name}: {beats} beats at {address:#x}")
        if name == "m_axi_ar":
            self.reads.append(beats)
            self.bursts_read.append((address, beats))
            self.asked += beats
            if len(self.reads) > BURSTS:
                self.say(f"{len(self.reads)} bursts asked for")
        else:
            self.writes.append(beats)
            self.bursts_written.append((address, beats))
            self.unanswered += 1
            if self.unanswered > BURSTS:
                self.say(f"{self.unanswered} bursts to be answered")

    def _write(self, strobes: str, last: str) -> None:
        if "0" in strobes:
            self.say(f"strobes {strobes}")
        self.sent += 1
        if not self.writes:
            self.say("W without a burst")
            return
        self.writes[0] -= 1
        if (last == "1") != (self.writes[0] == 0):
            self.say(f"wlast {last} with {self.writes[0]} beats to go")
        if self.writes[0] <= 0:
            self.writes.pop(0)
            self.complete += 1

    def _read(self) -> None:
        self.beats_read.append(self.clock)
        if not self.reads:
            self.say("R without a burst: the memory's error")
            return
        self.reads[0] -= 1
        if self.reads[0] == 0:
            self.reads.pop(0)

    def quiet(self) -> bool:
        """Return True if no transaction is open."""
        return not (self.reads or self.writes or self.unanswered)
