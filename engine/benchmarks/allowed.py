"""How long proved contacts of links take, and what 10,000 random poses make of them.

    python engine/benchmarks/allowed.py ARM.toml ...

For each arm: processor time, the verdicts, and of pairs that are sometimes in contact how many of
SEEDS samples of POSES poses each never saw it: they would call it "never".
"""

import sys
import time
from collections import Counter

import numpy as np

from cspace import load_robot
from cspace.arms.allowed import LinkContact, Spheres, allowed_collisions, pair_forms
from cspace.arms.links import links
from cspace.model.robot import Robot
from cspace.proofs.exact.problem import exact_robot

POSES = 10_000
SEEDS = 100
RARE = 40


def contacts_seen(arm: Robot, contact: LinkContact) -> list[int]:
    """Count poses in contact, sample by sample, by values of the forms in floats.

    A pair of which the first sample saw RARE or more is missed by none: the others are left out.
    """
    of_name = {link.name: link for link in links(arm)}
    pair = pair_forms(arm, *(of_name[name] for name in contact.links))
    low, high = pair.box
    counts = []
    for seed in range(SEEDS):
        q = np.random.default_rng(seed).uniform(low, high, (POSES, len(low)))
        counts.append(int((pair.values(q) < 0).any(axis=1).sum()))
        if counts[0] >= RARE:
            break
    return counts


def main() -> None:
    for file in sys.argv[1:]:
        start = time.process_time()
        found = allowed_collisions(file)
        seconds = time.process_time() - start
        verdicts = Counter(each.spheres.value for each in found)
        told = ", ".join(f"{count} {word}" for word, count in verdicts.items())
        print(f"{load_robot(file).name}: {len(found)} pairs in {seconds:.1f} s: {told}")
        arm = exact_robot(file)
        for each in found:
            if each.spheres is Spheres.SOMETIMES:
                counts = contacts_seen(arm, each)
                missed, part = counts.count(0), np.mean(counts) / POSES
                if missed:
                    print(
                        f"  {', '.join(each.links)}: {-each.gap:.3g} deep, in {part:.2g} of all"
                        f" poses; {missed} of {SEEDS} samples of {POSES} saw no contact"
                    )


if __name__ == "__main__":
    main()
