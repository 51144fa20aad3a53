"""What a 3dm file promises: its size, the number of its objects, and checksums.

The file is a row of chunks, each with its code and length, and the last one holds the size of the file.
openNURBS reads what is left of a damaged file without a word, so this is checked first.
"""

import struct
import uuid
import zlib

START = b"3D Geometry File Format"
HEADER_BYTES = 32
LONG_LENGTHS = 50  # version from which on lengths have eight bytes; four before
NO_BODY = 0x80000000  # bit of the code of a chunk that is a number alone
END_OF_FILE, OBJECT_TABLE, OBJECT_RECORD = 0x7FFF, 0x10000013, 0x20008070
CLASS, CLASS_ID, CLASS_DATA = 0x27FFA, 0x2FFFB, 0x2FFFC
PLAIN = {  # classes whose data hold no further chunks, so that their checksum is over all bytes
    uuid.UUID("4ed7d4dd-e947-11d3-bfe5-0010830122f0").bytes_le,  # ON_NurbsCurve
    uuid.UUID("4ed7d4de-e947-11d3-bfe5-0010830122f0").bytes_le,  # ON_NurbsSurface
}


def objects_promised(data):
    """How many objects the bytes of a file hold; ValueError if a part is missing or changed."""
    if not data.startswith(START) or not data[len(START) : HEADER_BYTES].strip().isdigit():
        raise ValueError("it is no 3dm file")
    form = "<Iq" if int(data[len(START) : HEADER_BYTES]) >= LONG_LENGTHS else "<Ii"
    chunks = list(_chunks(data, HEADER_BYTES, form))
    if not chunks or chunks[-1][0] != END_OF_FILE:
        raise ValueError("its end mark is missing; the file was cut off")
    if int.from_bytes(chunks[-1][1], "little") != len(data):
        raise ValueError("its size is not the one that its end mark says; a part of it is missing")
    table = next((body for code, body in chunks if code == OBJECT_TABLE), b"")
    records = [body for code, body in _chunks(table, 0, form) if code == OBJECT_RECORD]
    for record in records:
        for body in (body for code, body in _chunks(record[:-4], 0, form) if code == CLASS):
            parts = dict(_chunks(body, 0, form))
            if CLASS_ID in parts and _checked(parts[CLASS_ID]) in PLAIN:
                _checked(parts.get(CLASS_DATA, b""))
    return len(records)


def _chunks(data, start, form):
    """Code and body of every chunk from ``start`` to the end of the bytes."""
    size = struct.calcsize(form)
    while start + size <= len(data):
        code, length = struct.unpack_from(form, data, start)
        start += size
        if code & NO_BODY:
            yield code, b""
            continue
        if not 0 <= length <= len(data) - start:
            raise ValueError("one of its parts is longer than the file; it is damaged")
        yield code, data[start : start + length]
        start += length


def _checked(body):
    """The body of a chunk without the checksum at its end, which must be right."""
    if zlib.crc32(body[:-4]).to_bytes(4, "little") != body[-4:]:
        raise ValueError("a checksum in it is wrong; it is damaged")
    return body[:-4]
