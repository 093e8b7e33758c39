"""The smallest possible ONNX files, written by hand, so that tests need no exporter.

Source: onnx/onnx.proto3. Only the fields that a reader insists on.
"""


def _varint(value: int) -> bytes:
    out = bytearray()
    while True:
        value, low = value >> 7, value & 0x7F
        out.append(low | (0x80 if value else 0))
        if not value:
            return bytes(out)


def _number(field: int, value: int) -> bytes:
    return _varint(field << 3) + _varint(value)


def _bytes(field: int, value: bytes | str) -> bytes:
    data = value.encode() if isinstance(value, str) else value
    return _varint(field << 3 | 2) + _varint(len(data)) + data


def _value_info(name: str, shape: tuple[int, ...]) -> bytes:
    dims = b"".join(_bytes(1, _number(1, side)) for side in shape)
    tensor = _number(1, 1) + _bytes(2, dims)  # elem_type FLOAT
    return _bytes(1, name) + _bytes(2, _bytes(1, tensor))


def identity_model(shape: tuple[int, ...], inputs: int = 1) -> bytes:
    """A model whose output is its first input."""
    node = _bytes(1, "input0") + _bytes(2, "output") + _bytes(4, "Identity")
    graph = _bytes(1, node) + _bytes(2, "graph")
    graph += b"".join(_bytes(11, _value_info(f"input{i}", shape)) for i in range(inputs))
    graph += _bytes(12, _value_info("output", shape))
    opset = _bytes(1, "") + _number(2, 13)
    return _number(1, 8) + _bytes(7, graph) + _bytes(8, opset)
