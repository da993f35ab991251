"""PNG encoding with a deflate coder of our own: literals only, one Huffman code per block.

The bytes therefore depend on this file alone and not on the version of zlib. Palette and RGB, 8 bits.
"""

import heapq
import struct
import zlib
from collections import Counter
from math import log2

BLOCK_BYTES = 1 << 16
END_OF_BLOCK = 256
CODE_LENGTH_ORDER = (16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15)


def _code_lengths(counts, limit):
    """Huffman code lengths {symbol: bits} for {symbol: count}; flattens the counts until `limit` holds."""
    counts = dict(counts)
    if len(counts) == 1:
        return {symbol: 1 for symbol in counts}
    while True:
        heap = [(count, symbol, (symbol,)) for symbol, count in sorted(counts.items())]
        heapq.heapify(heap)
        lengths = dict.fromkeys(counts, 0)
        while len(heap) > 1:
            count_a, tie, symbols_a = heapq.heappop(heap)
            count_b, _, symbols_b = heapq.heappop(heap)
            for symbol in symbols_a + symbols_b:
                lengths[symbol] += 1
            heapq.heappush(heap, (count_a + count_b, tie, symbols_a + symbols_b))
        if max(lengths.values()) <= limit:
            return lengths
        counts = {symbol: (count + 3) // 4 for symbol, count in counts.items()}


def _canonical_codes(lengths):
    """{symbol: bit string in stream order} of the canonical code (RFC 1951, 3.2.2)."""
    codes = {}
    code = 0
    previous = 0
    for length, symbol in sorted((length, symbol) for symbol, length in lengths.items()):
        code <<= length - previous
        codes[symbol] = format(code, f"0{length}b")
        code += 1
        previous = length
    return codes


def _number(value, bits):
    """A plain number: least significant bit first."""
    return format(value, f"0{bits}b")[::-1]


def _block(data, final):
    """One deflate block with a dynamic code as a bit string (RFC 1951, 3.2.7)."""
    counts = Counter(data)
    counts[END_OF_BLOCK] = 1
    lengths = _code_lengths(counts, 15)
    codes = _canonical_codes(lengths)
    table = [lengths.get(symbol, 0) for symbol in range(END_OF_BLOCK + 1)] + [1]
    tokens = []  # (symbol, extra bits): runs of zero lengths are folded, the rest is spelled out
    index = 0
    while index < len(table):
        run = 0
        while index + run < len(table) and table[index + run] == 0 and run < 138:
            run += 1
        if run >= 11:
            tokens.append((18, _number(run - 11, 7)))
        elif run >= 3:
            tokens.append((17, _number(run - 3, 3)))
        else:
            run = 1
            tokens.append((table[index], ""))
        index += run
    meta_lengths = _code_lengths(Counter(symbol for symbol, _ in tokens), 7)
    meta_codes = _canonical_codes(meta_lengths)
    header = [_number(int(final), 1), _number(2, 2), _number(0, 5), _number(0, 5), _number(15, 4)]
    header += [_number(meta_lengths.get(symbol, 0), 3) for symbol in CODE_LENGTH_ORDER]
    header += [meta_codes[symbol] + extra for symbol, extra in tokens]
    return "".join(header) + "".join([codes[byte] for byte in data]) + codes[END_OF_BLOCK]


def deflate(data):
    """A zlib stream that holds `data`."""
    blocks = [data[start:start + BLOCK_BYTES] for start in range(0, len(data), BLOCK_BYTES)] or [b""]
    stream = bytearray(b"\x78\x01")
    pending = ""
    for index, block in enumerate(blocks):
        bits = pending + _block(block, index == len(blocks) - 1)
        whole = len(bits) // 8 if index < len(blocks) - 1 else (len(bits) + 7) // 8
        chunk, pending = bits[:whole * 8], bits[whole * 8:]
        stream += int(chunk[::-1], 2).to_bytes(whole, "little")
    return bytes(stream) + struct.pack(">I", zlib.adler32(data))


def _paeth(left, up, corner):
    distance_left, distance_up, distance_corner = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
    if distance_left <= distance_up and distance_left <= distance_corner:
        return left
    return up if distance_up <= distance_corner else corner


def _filtered(kind, row, above, step):
    """One scan line after PNG filter `kind` (0 none, 1 sub, 2 up, 4 Paeth)."""
    if kind == 0:
        return row
    if kind == 2:
        return bytes([(a - b) & 255 for a, b in zip(row, above)])
    shifted = bytes(step) + row[:-step]
    if kind == 1:
        return bytes([(a - b) & 255 for a, b in zip(row, shifted)])
    corner = bytes(step) + above[:-step]
    return bytes([(a - _paeth(b, c, d)) & 255 for a, b, c, d in zip(row, shifted, above, corner)])


def _entropy(data):
    counts = Counter(data)
    return -sum(count * log2(count / len(data)) for count in counts.values())


def _chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def _encode(rows, width, colour_type, step, palette_chunk):
    rows = [bytes(row) for row in rows]
    assert all(len(row) == width * step for row in rows)
    sample = range(1, len(rows), max(1, len(rows) // 48))
    kind = min((0, 1, 2, 4), key=lambda k: (_entropy(b"".join(
        _filtered(k, rows[y], rows[y - 1], step) for y in sample)), k))
    body = bytearray()
    above = bytes(width * step)
    for row in rows:
        body.append(kind)
        body += _filtered(kind, row, above, step)
        above = row
    header = struct.pack(">IIBBBBB", width, len(rows), 8, colour_type, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", header) + palette_chunk
            + _chunk(b"IDAT", deflate(bytes(body))) + _chunk(b"IEND", b""))


def encode_palette(rows, palette):
    """PNG of rows of palette indices; `palette` is at most 256 (r, g, b) byte triples."""
    assert len(palette) <= 256
    return _encode(rows, len(rows[0]), 3, 1, _chunk(b"PLTE", bytes(v for colour in palette for v in colour)))


def encode_rgb(rows):
    """PNG of rows of interleaved r, g, b bytes."""
    return _encode(rows, len(rows[0]) // 3, 2, 3, b"")
