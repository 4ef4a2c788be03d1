"""Feed a reader with what coverage finds, for a while: ``make fuzz``. Needs the extra ``fuzz``.

A crash, a reading that takes more than a second of processor time, one that does not end, or too much memory
ends it with what did it, kept beside. What is known to be heavy is tried before: tests/tools/heavy.py.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import atheris

with atheris.instrument_imports(include=["algorithms.files", "app.page.lesson.lesson_texts", "yaml"]):
    from readers import MOST_MEMORY, READERS, SHAPES, TooSlowError, reads

MOST_BYTES = 1_000_000
BEGINNING = 500  # bytes; begun with 32 kB each, most of the time would go into a few hundred readings
HEAVY = str(Path(__file__).with_name("heavy.py"))
MOST_WAIT = 60  # s by the clock; libFuzzer looks at it now and then, so only what hangs is found by it


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
    fuzzers = {
        name: [sys.executable, __file__, name, "--seconds", str(args.seconds), "--out", str(args.out)]
        for name in READERS  # the fuzzer ends its process: each reader has one of its own
    }
    for name, command in {"heavy files": [sys.executable, HEAVY], **fuzzers}.items():
        print(f"--- {name}", flush=True)
        if subprocess.run(command).returncode:
            failed.append(name)
    print(
        f"failed: {', '.join(failed)}"
        if failed
        else "no crash, and no reading beyond its seconds or its memory"
    )
    return 1 if failed else 0


def fuzz(name: str, seconds: int, out: Path) -> int:
    reader, good = READERS[name]
    slow = out / f"{name}-slow"

    def tried(data: bytes) -> None:
        try:
            reads(reader, data, peak=MOST_MEMORY)
        except TooSlowError:
            # Being watched makes Python up to 20 times slower: what it takes by itself is what counts.
            slow.write_bytes(data)
            if subprocess.run([sys.executable, HEAVY, slow], stdout=subprocess.DEVNULL).returncode:
                raise
            slow.unlink()

    with TemporaryDirectory() as corpus:
        beginnings = [data[:BEGINNING] for data in SHAPES.values()]  # heavy.py tries the whole
        for k, data in enumerate([*good, *beginnings]):
            Path(corpus, f"{k:03}").write_bytes(data)
        limits = [f"-max_total_time={seconds}", f"-timeout={MOST_WAIT}", f"-max_len={MOST_BYTES}"]
        atheris.Setup(
            [sys.argv[0], corpus, *limits, f"-rss_limit_mb={MOST_MEMORY}", f"-artifact_prefix={out}/{name}-",
             "-verbosity=0", "-print_final_stats=1"],
            tried,
        )  # fmt: skip
        atheris.Fuzz()
    return 0


if __name__ == "__main__":
    sys.exit(main())
