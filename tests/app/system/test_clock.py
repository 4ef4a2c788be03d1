"""The date in files: now, or what SOURCE_DATE_EPOCH says."""

from datetime import datetime, timezone

import pytest

from algorithms.common.errors import SettingError
from app.system.clock import made_at

FORM = "%Y-%m-%dT%H:%M:%SZ"


def test_it_is_now_in_utc_as_iso_8601_writes_it(monkeypatch):
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    before = datetime.now(timezone.utc).replace(microsecond=0)
    told = datetime.strptime(made_at(), FORM).replace(tzinfo=timezone.utc)
    assert before <= told <= datetime.now(timezone.utc)


def test_the_environment_sets_it(monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    assert made_at() == "2023-11-14T22:13:20Z"


@pytest.mark.parametrize("odd", ["tomorrow", "1.5", "9" * 30])
def test_what_is_no_number_of_seconds_is_told(monkeypatch, odd):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", odd)
    with pytest.raises(SettingError, match=r"SOURCE_DATE_EPOCH is .*; give whole seconds since 1970"):
        made_at()
