"""What is to be sent, decided from what is wanted, what is there and what was begun: all of it, nothing twice."""

from uuid import UUID

from hypothesis import given, settings
from hypothesis import strategies as st

from backend.uploads.planning import BUNDLE_BYTES, BUNDLE_FILES, Open, bundles, decide
from backend.uploads.schemas import Announced

NAMES = [f"frame{number}.tif" for number in range(8)]
files = st.builds(Announced, name=st.sampled_from(NAMES), size_bytes=st.integers(1, 3))
distinct = st.lists(files, max_size=8, unique_by=lambda file: file.name)
sums = st.sampled_from(["a" * 64, "b" * 64])
there = st.dictionaries(st.sampled_from([("frames", name) for name in NAMES]), st.tuples(st.integers(1, 3), sums))


@st.composite
def begun(draw: st.DrawFn) -> list[Open]:
    uploads = draw(st.lists(distinct.filter(len), max_size=3))
    flags = st.booleans()
    return [
        Open(UUID(int=number), files, is_held=draw(flags), is_refused=draw(flags))
        for number, files in enumerate(uploads)
    ]


@settings(max_examples=100, deadline=None)
@given(distinct, there, begun())
def test_every_wanted_file_is_there_or_sent_exactly_once(wanted, there, begun) -> None:  # type: ignore[no-untyped-def]
    decision = decide(wanted, there, begun)
    sent = [index for group in (*decision.go_on.values(), *decision.begin) for index in group]
    assert sorted([*decision.present, *sent]) == list(range(len(wanted)))


@settings(max_examples=100, deadline=None)
@given(distinct, there, begun())
def test_what_was_announced_stays_announced(wanted, there, begun) -> None:  # type: ignore[no-untyped-def]
    decision = decide(wanted, there, begun)
    ended = {upload.id: upload for upload in begun if upload.id in decision.end}
    kept = {file.name for group in decision.keep_announced for file in group}
    for upload in ended.values():
        asked = {file.name for file in wanted}
        if not upload.is_refused:
            present = {wanted[index].name for index in decision.present}
            assert {file.name for file in upload.files} - asked - present <= kept
    assert not any(upload.is_held for upload in ended.values())


@settings(max_examples=100, deadline=None)
@given(distinct, there)
def test_the_same_question_again_goes_on_with_the_same_uploads(wanted, there) -> None:  # type: ignore[no-untyped-def]
    first = decide(wanted, there, [])
    open_now = [
        Open(UUID(int=number), [wanted[index] for index in group], is_held=False)
        for number, group in enumerate(first.begin)
    ]
    again = decide(wanted, there, open_now)
    assert (again.begin, again.end, again.present) == ([], [], first.present)
    assert list(again.go_on.values()) == first.begin


@given(st.lists(st.integers(1, BUNDLE_BYTES * 2), max_size=50))
def test_uploads_are_neither_too_large_nor_of_too_many_files(sizes: list[int]) -> None:
    wanted = [Announced(name=f"{number}.tif", size_bytes=size) for number, size in enumerate(sizes)]
    groups = bundles(wanted, range(len(wanted)))
    assert [index for group in groups for index in group] == list(range(len(wanted)))
    for group in groups:
        assert len(group) == 1 or sum(sizes[index] for index in group) <= BUNDLE_BYTES
        assert len(group) <= BUNDLE_FILES
