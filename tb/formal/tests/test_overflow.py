# SPDX-License-Identifier: Apache-2.0
"""Tests of the proofs that nothing overflows: netlist, exact values, formulas and questions."""

import itertools
import re
from concurrent.futures import ThreadPoolExecutor

import pytest

from tb.formal import design, exact_values, netlist, overflow, range_table
from tb.formal.claims import Question, corners, floor_of, integers, word
from tb.formal.range_table import Range, model_nodes
from tb.formal.tools import missing
from tb.formal.unrolled import Unrolled, ask

needs_tools = pytest.mark.skipif(
    bool(missing()), reason="the tools of requirements/fpga.lock are missing: `make formal`"
)


def test_nothing_is_assumed_in_the_properties():
    found = [p.name for p in sorted(design.PROPERTIES.glob("*.vh")) if re.search(r"\bassume\b", p.read_text())]
    assert found == [] and "assume (" not in "".join(map(exact_values.properties, exact_values.SECTIONS))


def test_exact_values_are_of_nodes_that_are_words():
    for section, values in exact_values.SECTIONS.items():
        for name, value in values.items():
            node = model_nodes(32)[name]
            assert node.format.width > 1
            assert node.format.signed == (value.held == name), name
            assert f"holds_{name} : assert" in exact_values.properties(section)


def test_ranges_are_words_of_their_format():
    nodes = model_nodes(32)
    for name, r in range_table.table(32).items():
        assert nodes[name].format.low <= r.low <= r.high <= nodes[name].format.high, name


@pytest.mark.parametrize("square", (False, True))
def test_corners_bound_every_product(square):
    ends = [Range(*pair) for pair in itertools.combinations(range(-4, 5), 2)]
    for a, b in itertools.product(ends, repeat=2):
        words = [(x, x) for x in range(a.low, a.high + 1)] if square else None
        words = words or list(itertools.product(range(a.low, a.high + 1), range(b.low, b.high + 1)))
        products = [x * y for x, y in words]
        low, high = corners(a, a if square else b, square)
        assert low <= min(products) and high == max(products)
        assert square or low == min(products)


def tiny(bits_of_b, module="ik_delay"):
    """Return node b of a section u_s as a function of node a (bits 2 to 5), delayed."""
    delay = {
        "attributes": {"hdlname": module},
        "parameter_default_values": {"N": "11", "W": "100"},
        "cells": {},
        "ports": {"d": {"direction": "input", "bits": [2]}, "q": {"direction": "output", "bits": [6]}},
        "netnames": {},
    }
    section = {
        "attributes": {},
        "ports": {"a": {"direction": "input", "bits": [2, 3, 4, 5]}},
        "netnames": {"a": {"bits": [2, 3, 4, 5]}},
        "cells": {"u_d": {"type": "ik_delay", "connections": {"d": [2, 3, 4, 5], "q": [6, 7, 8, 9]}}},
    }
    top = {
        "attributes": {},
        "ports": {},
        "netnames": {},
        "cells": {"u_s": {"type": "ik_s", "connections": {"a": [2, 3, 4, 5]}}},
    }
    design = {"modules": {"top": top, "ik_s": section, "ik_delay": delay}}
    found = netlist.Netlist(design, "top", {"a": ("u_s", 4)}, {"a": True})
    return found.value("b", "u_s", bits_of_b)


@pytest.mark.parametrize("module", netlist.DELAYS)
def test_operand_is_found_behind_delay_shift_and_extension(module):
    found = tiny(["0", "0", 6, 7, 8, 9, 9], module)
    assert found == netlist.Operand("a", shift=2, width=4, clocks=3)


@pytest.mark.parametrize(("module", "outside"), [*((m, False) for m in netlist.OWN), ("ik_mul", True)])
def test_own_logic_of_a_section_does_not_come_from_outside(module, outside):
    """Results of section logic must not be assumed in range, because they are to be proved."""
    ports = {"d": {"direction": "input", "bits": [2]}, "q": {"direction": "output", "bits": [3]}}
    inner = {"attributes": {"hdlname": module}, "cells": {}, "netnames": {}, "ports": ports}
    cell = {"type": "inner", "connections": {"d": [2], "q": [3]}}
    top = {"attributes": {}, "ports": {}, "netnames": {}, "cells": {"u_s": {"type": "s", "connections": {}}}}
    section = {"attributes": {}, "ports": {}, "netnames": {"q": {"bits": [3]}}, "cells": {"u_q": cell}}
    design = {"modules": {"top": top, "s": section, "inner": inner}}
    found = netlist.Netlist(design, "top", {"q": ("u_s", 1)}, {"q": True})
    assert found.from_outside("u_s", [3]) == outside
    assert (found.driver("q").module == module) == outside


def operand_of_an_operator(beside, delayed=(2, 3)):
    """Return a netlist in which node a, operand b of an operator, is delayed by 3 clocks outside and 2 inside."""
    ports = {"b": {"direction": "input", "bits": [2, 3]}, "q": {"direction": "output", "bits": [9]}}
    inside = {
        "u_b": {"type": "delay2", "connections": {"d": list(delayed), "q": [4, 5]}},
        "sum": {"type": "$add", "connections": {"A": [4, 2 if beside else 5], "Y": [9]}},
    }
    operator = {
        "attributes": {"hdlname": "ik_mul"},
        "parameter_default_values": {"DB": "10", "W": "10"},
        "cells": inside,
        "netnames": {},
        "ports": ports,
    }
    wait = {"d": {"direction": "input", "bits": [2]}, "q": {"direction": "output", "bits": [3]}}
    delays = {
        f"delay{n}": {
            "attributes": {"hdlname": "ik_delay"},
            "parameter_default_values": {"N": f"{n:b}", "W": "10"},
            "cells": {},
            "netnames": {},
            "ports": wait,
        }
        for n in (2, 3)
    }
    section = {
        "attributes": {},
        "ports": {"a": {"direction": "input", "bits": [2, 3]}},
        "netnames": {"a": {"bits": [2, 3]}, "q": {"bits": [6]}},
        "cells": {
            "u_late": {"type": "delay3", "connections": {"d": [2, 3], "q": [4, 5]}},
            "u_q": {"type": "operator", "connections": {"b": [4, 5], "q": [6]}},
        },
    }
    top = {"attributes": {}, "ports": {}, "netnames": {}, "cells": {"u_s": {"type": "s", "connections": {"a": [2, 3]}}}}
    design = {"modules": {"top": top, "s": section, "operator": operator, **delays}}
    return netlist.Netlist(design, "top", {"a": ("u_s", 2), "q": ("u_s", 1)}, {"a": True, "q": True})


def test_delays_inside_of_an_operator_count():
    found = operand_of_an_operator(beside=False)
    assert found.operand("u_s.u_q", "b") == netlist.Operand("a", width=2, clocks=5)
    assert found.driver("q").values == {"W": 2}, "an operator is proved without its delays"


def test_an_operand_used_beside_its_delay_is_refused():
    with pytest.raises(netlist.NetlistError, match="b is used both delayed and undelayed"):
        operand_of_an_operator(beside=True).operand("u_s.u_q", "b")


@pytest.mark.parametrize("delayed", [(3, 7), (3,), (2, 3, 7)])
def test_internal_delay_of_an_operator_is_not_a_delay_of_the_operand(delayed):
    """Example: the sign of a root is delayed with the root."""
    assert operand_of_an_operator(beside=True, delayed=delayed).operand("u_s.u_q", "b").clocks == 3


def test_constant_is_signed():
    assert tiny(["1", "0", "1"]).constant == -3


@pytest.mark.parametrize("bits", ([6, 7, 9, 8], [6, 7, 8, 9, 8], ["1", 6, 7, 8, 9], [2, 7, 8, 9]))
def test_what_is_no_word_of_a_node_is_refused(bits):
    with pytest.raises(netlist.NetlistError):
        tiny(bits)


def test_slice_and_zeros_are_unsigned():
    assert tiny([2, 3, 4]) == netlist.Operand("a", width=3, signed=False)
    assert not tiny([2, 3, 4, 5, "0"]).signed


FORMULA = r"""; yosys-smt2-module t
(declare-sort |t_s| 0)
(declare-fun |t_is| (|t_s|) Bool)
(declare-fun |t#0| (|t_s|) (_ BitVec 4)) ; \a
; yosys-smt2-wire a 4
(define-fun |t_n a| ((state |t_s|)) (_ BitVec 4) (|t#0| state))
(declare-fun |t#1| (|t_s|) (_ BitVec 4)) ; \q
(define-fun |t_n q| ((state |t_s|)) (_ BitVec 4) (|t#1| state))
; yosys-smt2-assert 0 small
(define-fun |t_a 0| ((state |t_s|)) Bool (bvsle (|t#1| state) #x3)) ; small
(define-fun |t_u| ((state |t_s|)) Bool true)
(define-fun |t_i| ((state |t_s|)) Bool true)
(define-fun |t_h| ((state |t_s|)) Bool true)
(define-fun |t_t| ((state |t_s|) (next_state |t_s|)) Bool (and
  (= (|t#0| state) (|t#1| next_state)) ; \q
)) ; end of module t
; yosys-smt2-topmod t
; end of yosys output
"""


def test_formula_is_unrolled_into_constants():
    text = Unrolled(FORMULA).clocks(2)
    assert "state" not in text and text.count("(declare-fun") == 6
    assert "(= |t#0@0| |t#1@1|)" in text and "(= |t#0@1| |t#1@2|)" in text


@needs_tools
@pytest.mark.parametrize(("most", "said"), [(3, "unsat"), (4, "sat")])
def test_range_of_an_input_bounds_the_register_behind_it(most, said):
    formula = Unrolled(FORMULA)
    fact = formula.between("a", 0, -8, most, True)
    assert ask(f"{formula.clocks(1)}\n(assert {fact})\n(assert (not {formula.holds('small', 1)}))").said == said


def test_range_without_a_word_is_refused():
    with pytest.raises(ValueError, match="no word of 4 bits"):
        Unrolled(FORMULA).between("a", 0, 8, 9, True)


@needs_tools
@pytest.mark.parametrize(("bits", "said"), [(9, "unsat"), (8, "sat")])
def test_integers_bound_a_rounded_product(bits, said):
    """127 * 127 / 64 rounded is 252: 9 bits with the sign."""
    facts = ["(<= 0 p 16129)", floor_of("v", "(+ p 32)", 6)]
    assert ask(integers("p v", facts, word("v", bits))).said == said


@needs_tools
@pytest.mark.parametrize(("claim", "said"), [("(or c (= n 1))", "sat"), ("(=> c (= n 1))", "unsat")])
def test_every_case_is_asked(claim, said):
    """The first claim holds only if c does, the second in both cases."""

    def text(facts, claims):
        facts = "".join(f"(assert {fact})" for fact in facts)
        return f"(declare-const c Bool)(declare-const n Int){facts}(assert (not (and {' '.join(claims)})))"

    question = Question("integers", 0, text, [], [], [], "", ("c",))
    assert question.ask(["(=> c (= n 1))"], [claim]).said == said


@needs_tools
@pytest.mark.slow
def test_one_node_and_the_bug():
    """Prove one sum and find the seeded bug in a product, in seconds."""
    with ThreadPoolExecutor(2) as pool:
        outcome = overflow.run(16, pool, print, ["s"])
    assert outcome.failed == [] and [row[0] for row in outcome.table[1:2]] == ["s"]
