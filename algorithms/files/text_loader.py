"""Reads YAML as Nav2's parser does: every scalar as its text, tabs as blanks, and within bounds."""

from __future__ import annotations

import re
from collections.abc import Hashable
from typing import Any

import yaml

MAX_DEPTH = 20  # of lists and mappings in each other; ours are 3 deep
MAX_ALIASES = 64
MAX_VALUES = 5000  # keys count, too; 64 sightings have 2,000
LINE_ENDS = "\0\r\n\x85\u2028\u2029"
HALVES = re.compile(r"[\ud800-\udfff]")  # of characters: no such text can be sent or saved


class TextLoader(yaml.BaseLoader):
    """Mappings, lists and texts only; a key given twice is an error, not a silent choice.

    Composing takes what the scanner finds as it comes, so its bounds end the scanning, too: that takes a
    time that grows with the square of the depth.
    """

    _aliases = _values = _depth = 0
    most_values = MAX_VALUES

    def scan_to_next_token(self) -> None:
        """Pass over blanks and comments. As for yaml-cpp, which Nav2 reads with, tabs are blanks, too, but in
        the indentation of a line.
        """
        indents = self.column == 0
        while True:
            while self.peek() == " " or (self.peek() == "\t" and (not indents or self._nothing_more())):
                self.forward()
            if self.peek() == "#":
                while self.peek() not in LINE_ENDS:
                    self.forward()
            if not self.scan_line_break():  # type: ignore[no-untyped-call]
                return
            indents = not self.flow_level
            if not self.flow_level:
                self.allow_simple_key = True

    def _nothing_more(self) -> bool:
        """Whether the rest of the line is blank, or a comment."""
        ahead = 0
        while self.peek(ahead) in (" ", "\t"):
            ahead += 1
        return self.peek(ahead) in ("#", *LINE_ENDS)

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        self._values += 1
        self._aliases += self.check_event(yaml.AliasEvent)
        if self._values > self.most_values or self._aliases > MAX_ALIASES:
            raise yaml.composer.ComposerError(None, None, "it holds too many values", None)
        if self._depth >= MAX_DEPTH and self.check_event(yaml.CollectionStartEvent):
            raise RecursionError
        self._depth += 1
        node: yaml.Node | None = super().compose_node(parent, index)
        self._depth -= 1
        return node

    def compose_scalar_node(self, anchor: Any) -> yaml.ScalarNode:
        node: yaml.ScalarNode = super().compose_scalar_node(anchor)
        half = HALVES.search(node.value)  # only an escape can write one
        if half:
            problem = f"a text holds half a character, U+{ord(half[0]):04X}"
            raise yaml.composer.ComposerError(None, None, problem, node.start_mark)
        return node

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen: set[str] = set()
        for key_node, _ in node.value:
            key = str(key_node.value)
            if key in seen:
                problem = f"the key {key} stands there twice"
                raise yaml.constructor.ConstructorError(None, None, problem, key_node.start_mark)
            seen.add(key)
        return super().construct_mapping(node, deep=deep)


def goes_on(loader: TextLoader) -> bool:
    """Whether another document follows; what is no YAML any more is none of the first one's business."""
    try:
        return bool(loader.check_data())  # type: ignore[no-untyped-call]
    except yaml.YAMLError:
        return True
