# SPDX-License-Identifier: Apache-2.0
"""Inputs of a section's module, derived from the dataflow."""


def inputs(section: str, nodes) -> dict[str, tuple]:
    """Return port of a section's module -> (node, clock in which the port holds it).

    A port has the name and clock of its node. The target is the exception: 3.2 and 3.5 receive it delayed to the clock
    of the swivel plane, on ports named ``p_w_x_at_pi_swivel`` and so on.
    """
    ports = {}
    for node in nodes.values():
        if node.section != section or node.op == "input":
            continue
        for source in (*node.operands, *([node.after] if node.after else [])):
            if source.op == "constant" or (source.section == section and source.op != "input"):
                continue
            if source.name.startswith("p_w_") and section in ("elbow", "to_wrist"):
                ports[f"{source.name}_at_pi_swivel"] = (source, nodes["pi_swivel_x"].time)
            else:
                ports[source.name] = (source, source.time)
    return ports
