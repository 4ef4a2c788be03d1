"""Feed a reader with what coverage finds, for a while: ``make fuzz``. Needs the extra ``fuzz``.

A crash, a reading of more than a second or too much memory ends it with what did it, kept beside.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import atheris

with atheris.instrument_imports(
    include=["algorithms.mapio", "algorithms.casefiles", "app.lesson.texts", "yaml"]
):
    from readers import MOST_MEMORY, MOST_SECONDS, READERS, SHAPES, reads


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("reader", nargs="?", choices=READERS, help="one of them; default: all in turn")
    parser.add_argument("--seconds", type=int, default=30, help="for each reader")
    parser.add_argument(
        "--out", type=Path, default=Path("out/fuzz"), help="where a file that breaks it is kept"
    )
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    if args.reader:
        return fuzz(args.reader, args.seconds, args.out)
    failed = []
    for name in READERS:  # the fuzzer ends its process: each reader has one of its own
        print(f"--- {name}", flush=True)
        command = [sys.executable, __file__, name, "--seconds", str(args.seconds), "--out", str(args.out)]
        if subprocess.run(command).returncode:
            failed.append(name)
    print(f"failed: {', '.join(failed)}" if failed else "no crash, no reading of more than a second")
    return 1 if failed else 0


def fuzz(name: str, seconds: int, out: Path) -> int:
    reader, good = READERS[name]
    with TemporaryDirectory() as corpus:
        for k, data in enumerate([*good, *SHAPES.values()]):
            Path(corpus, f"{k:03}").write_bytes(data)
        # libFuzzer counts whole seconds: with 2 a reading of more than one is told
        limits = [f"-max_total_time={seconds}", f"-timeout={int(MOST_SECONDS) + 1}", "-max_len=40000"]
        atheris.Setup(
            [sys.argv[0], corpus, *limits, f"-rss_limit_mb={MOST_MEMORY}", f"-artifact_prefix={out}/{name}-",
             "-verbosity=0", "-print_final_stats=1"],
            lambda data: reads(reader, data),
        )  # fmt: skip
        atheris.Fuzz()
    return 0


if __name__ == "__main__":
    sys.exit(main())
