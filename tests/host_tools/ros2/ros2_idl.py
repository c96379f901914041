#!/usr/bin/python3
"""IDL of the messages of a ROS 2 package as they are on the wire, from its .msg files.

  ros2_idl.py PACKAGE FOLDER

ROS 2's own rosidl_adapter (Debian's python3-rosidl) turns each .msg into IDL in FOLDER/PACKAGE/msg; names become those
that ROS 2 gives types on DDS: pkg::msg::dds_::Type_.
"""
from __future__ import annotations

import pathlib
import re
import sys

from rosidl_adapter.msg import convert_msg_to_idl


def on_the_wire(text: str, package: str) -> str:
    """An IDL file of rosidl_adapter with the names of DDS."""
    text = re.sub(r'@verbatim \(language="comment", text=\s*(?:"(?:[^"\\]|\\.)*"\s*)+\)', '', text)
    text = text.replace('module msg {', 'module msg { module dds_ {')
    text = re.sub(r'\bstruct (\w+) \{', r'@topic struct \1_ {', text)
    text = re.sub(rf'\b{package}::msg::(\w+)', rf'{package}::msg::dds_::\1_', text)
    return re.sub(r'  \};\n\};\s*$', '  };\n};\n};\n', text)


def main() -> None:
    source, folder = map(pathlib.Path, sys.argv[1:])
    out = folder / source.name / 'msg'
    out.mkdir(parents=True, exist_ok=True)
    for message in sorted((source / 'msg').glob('*.msg')):
        idl = convert_msg_to_idl(source.resolve(), source.name, message.relative_to(source), out)
        idl.write_text(on_the_wire(idl.read_text(encoding='iso-8859-1'), source.name))


if __name__ == '__main__':
    main()
