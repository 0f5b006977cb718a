"""The loopback interface of a network namespace of its own (`unshare --net`)."""

import fcntl
import socket
import struct


def raise_loopback():
    """Sets the interface `lo` up, which a new namespace has down; there is no other."""
    up, request = 1, struct.pack("16sh14x", b"lo", 1)
    get, put = 0x8913, 0x8914
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        (flags,) = struct.unpack("16xh14x", fcntl.ioctl(control, get, request))
        fcntl.ioctl(control, put, struct.pack("16sh14x", b"lo", flags | up))
    assert [name for _, name in socket.if_nameindex()] == ["lo"]
