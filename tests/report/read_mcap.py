#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reads an MCAP file by its index alone, after the public specification, and prints rows of one topic as
`time_ns field=value ...`. Shares nothing with the program that wrote the file."""
import json
import struct
import sys
import zlib

MAGIC = b"\x89MCAP0\r\n"


def text(data, at):
    (size,) = struct.unpack_from("<I", data, at)
    return data[at + 4:at + 4 + size], at + 4 + size


def records(data, begin, end):
    while begin < end:
        kind, size = struct.unpack_from("<BQ", data, begin)
        yield kind, data[begin + 9:begin + 9 + size]
        begin += 9 + size
    assert begin == end, "records end where they should"


def main(path, topic):
    data = open(path, "rb").read()
    assert data[:8] == MAGIC and data[-8:] == MAGIC
    kind, size, summary, offsets, crc = struct.unpack_from("<BQQQI", data, len(data) - 8 - 29)
    assert kind == 2 and size == 20, "footer"
    assert crc == zlib.crc32(data[summary:len(data) - 12]), "checksum of the summary"
    channels, schemas, chunks, statistics = {}, {}, [], None
    for kind, body in records(data, summary, offsets):
        if kind == 3:
            (number,) = struct.unpack_from("<H", body)
            name, at = text(body, 2)
            encoding, at = text(body, at)
            content, at = text(body, at)
            assert encoding == b"jsonschema"
            schemas[number] = json.loads(content)
        elif kind == 4:
            number, schema = struct.unpack_from("<HH", body)
            name, at = text(body, 4)
            encoding, at = text(body, at)
            assert encoding == b"json"
            channels[number] = (name.decode(), schema)
        elif kind == 8:
            begin, end, at, length = struct.unpack_from("<QQQQ", body)
            places, after = text(body, 32)
            chunks.append((begin, end, at, length, dict(struct.iter_unpack("<HQ", places))))
        elif kind == 11:
            statistics = struct.unpack_from("<QHIIIIQQ", body)
    groups = list(records(data, offsets, len(data) - 8 - 29))
    assert all(kind == 14 for kind, _ in groups)
    for _, body in groups:
        kind, begin, length = struct.unpack("<BQQ", body)
        assert all(k == kind for k, _ in records(data, begin, begin + length))
    wanted = [n for n, (name, _) in channels.items() if name == topic]
    count = 0
    for begin, end, at, length, places in chunks:
        kind, size = struct.unpack_from("<BQ", data, at)
        assert kind == 6 and size + 9 == length
        body = data[at + 9:at + 9 + size]
        first, last, plain, crc = struct.unpack_from("<QQQI", body)
        assert (first, last) == (begin, end)
        compression, after = text(body, 28)
        assert compression == b""
        content = body[after + 8:]
        assert len(content) == plain and crc == zlib.crc32(content)
        for number, place in places.items():
            kind, size = struct.unpack_from("<BQ", data, place)
            assert kind == 7
            pairs = data[place + 9 + 6:place + 9 + size]
            for time, offset in struct.iter_unpack("<QQ", pairs):
                kind, size = struct.unpack_from("<BQ", content, offset)
                channel, sequence, log_time, _ = struct.unpack_from("<HIQQ", content, offset + 9)
                assert kind == 5 and channel == number and log_time == time and begin <= time <= end
                count += 1
                if number in wanted:
                    message = json.loads(content[offset + 9 + 22:offset + 9 + size])
                    known = schemas[channels[number][1]]["properties"]
                    assert set(message) <= set(known)
                    print(time, " ".join(f"{k}={v!r}" for k, v in message.items()))
    assert statistics[0] == count, "messages are as many as the statistics say"
    assert statistics[5] == len(chunks)


main(sys.argv[1], sys.argv[2])
