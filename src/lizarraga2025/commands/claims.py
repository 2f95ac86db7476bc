"""``lizarraga2025 claims``: the verdict on every statement, as recorded or computed anew."""

import argparse
import json
from pathlib import Path
from typing import Any

from lizarraga2025 import recorded
from lizarraga2025.ledger import cite
from lizarraga2025.ledger import claims as ledger
from lizarraga2025.ledger.claims import KINDS, SEVERITIES, Claim, claim
from lizarraga2025.verdicts import VERDICTS


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "claims",
        help="what holds of the paper, statement by statement",
        description="Print the ledger's entries: one line each, or whole, with what was computed"
        " and the test, those chosen by id or verdict.",
        epilog="exit status: 0 printed, 1 a value is another than the recorded one; 2 bad input\n"
        "--recompute needs cspace[notebooks], the project in engine/\n"
        "example: lizarraga2025 claims E-34 --recompute\n"
        "example: lizarraga2025 claims --verdict refuted --verdict misprint",
    )
    parser.add_argument("ids", nargs="*", metavar="ID", help="E-34, B-2.1.2, T-4, F-4.1, S-3, ...")
    parser.add_argument(
        "--verdict",
        action="append",
        choices=VERDICTS,
        metavar="VERDICT",
        help=f"in either reading: {'; '.join(VERDICTS)}; given twice, both",
    )
    parser.add_argument(
        "--severity",
        choices=SEVERITIES,
        help="of what is not confirmed in its likeliest reading: it changes the region or the"
        " workspace, a formula, words",
    )
    parser.add_argument("--kind", choices=KINDS)
    parser.add_argument("--json", action="store_true", help="as in results/claims.json")
    parser.add_argument("--bibtex", action="store_true", help="BibTeX entries of these claims")
    parser.add_argument(
        "--recompute",
        action="store_true",
        help="run the computation again; exit status 1 if the outcome is not the recorded one",
    )
    parser.add_argument(
        "--output",
        type=Path,
        metavar="FILE",
        help="with --recompute: compute every entry anew and write them to a file of claims",
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Print the chosen entries; with --recompute, 1 if one comes out otherwise than recorded."""
    if options.output:
        return _write(options)
    known = {content["id"]: ledger.from_content(content) for content in recorded.claims()}
    wanted = {name.upper() for name in options.ids}
    for name in (name for name in options.ids if name.upper() not in known):
        raise ValueError(f"no entry {name!r} in the ledger; `lizarraga2025 claims` lists all")
    chosen = [
        one
        for one in known.values()
        if (not wanted or one.id in wanted)
        and (not options.verdict or {one.likeliest, one.most_favourable} & {*options.verdict})
        and (options.severity is None or (one.severity == options.severity and not one.stands))
        and options.kind in (None, one.kind)
    ]
    if options.recompute:
        chosen = [_again(one.id) for one in chosen]
    changed = [one for one in chosen if one != known[one.id]]
    if options.json:
        content = {"schema": ledger.SCHEMA, "claims": [one.content() for one in chosen]}
        print(json.dumps(content, indent=1, ensure_ascii=False))
    elif options.bibtex:
        print("\n\n".join(cite.entry(one) for one in chosen) + "\n")
    else:
        _say(chosen, whole=bool(options.ids or options.verdict))
        if not options.ids:
            _count(chosen)
        if options.recompute:
            print(f"computed again: {len(chosen)}, as recorded: {len(chosen) - len(changed)}")
            for one in changed:
                _say_differences(one.content(), known[one.id].content())
    return 1 if changed else 0


def _write(options: argparse.Namespace) -> int:
    """Compute every entry, without a look at what is recorded, and write them."""
    if not options.recompute or options.ids or options.verdict or options.kind or options.severity:
        raise ValueError("--output writes every entry: give --recompute, and choose none")
    ledger.refuse_replacing(options.output)
    ledger.save([_again(name) for name in ledger.entries()], options.output)
    return 0


def _again(name: str) -> Claim:
    try:
        return claim(name)
    except ModuleNotFoundError as error:
        raise ImportError(
            f"to compute {name} again takes {error.name}, which is not installed:"
            " in a copy of the repository, pip install . './engine[notebooks]'"
        ) from error


def _say_differences(now: dict[str, Any], then: dict[str, Any]) -> None:
    """Say in which keys an entry differs from what is recorded, and how."""
    print(f"{now['id']} differs from what is recorded:")
    for key in (key for key in now if now[key] != then[key]):
        print(f"  {key:<10}recorded {then[key]!r}\n  {'':<10}now      {now[key]!r}")


def _say(chosen: list[Claim], whole: bool) -> None:
    for one in chosen:
        if not whole:
            print(f"{one.id:<10}{_verdicts(one):<29}{one.where}: {one.says}")
            continue
        print(f"{one.id}  {one.where}\n  says      {one.says}\n  reading   {one.reading}")
        print(f"  verdict   {_verdicts(one)}\n  computed  {one.computed}")
        if not one.stands:
            print(f"  severity  {one.severity}")
        if one.finding != one.id:
            print(f"  finding   of {one.finding}")
        if one.corrected:
            print(f"  corrected {one.corrected}")
        print(f"  evidence  {one.evidence.chapter}, {one.evidence.test}")


def _verdicts(one: Claim) -> str:
    """Return the verdict of the likeliest reading, and of the most favourable one if it differs."""
    if one.likeliest == one.most_favourable:
        return one.likeliest
    return f"{one.likeliest} (most favourable reading: {one.most_favourable})"


def _count(chosen: list[Claim]) -> None:
    favourable = ledger.counts(chosen, "most_favourable")
    for verdict, count in ledger.counts(chosen).items():
        most = favourable[verdict]
        if count.entries or most.entries:
            print(f"{verdict}: {count}; in the most favourable reading {most}")
    print(f"together: {ledger.Count(len(chosen), len(ledger.findings(chosen)))}")
