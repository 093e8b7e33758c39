"""Chooses the graphics device that habitat-sim draws with.

habitat-sim ends the whole program if the given device doesn't exist, so the devices are listed here
first, with the EGL calls that habitat-sim's own context makes (Magnum,
``WindowlessEglApplication``): the devices of ``EGL_EXT_device_enumeration``, and the CUDA number of
each by ``EGL_NV_device_cuda``.
"""

import ctypes
import sys

from hypernav.core.errors import MissingExtraError

DEFAULT_DEVICE = -1
"""habitat-sim's number for EGL's default device."""

_CUDA_DEVICE = 0x323A  # EGL_CUDA_DEVICE_NV of EGL/eglext.h
_MOST_DEVICES = 64
_INSTALL = (
    "install a driver: apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri (Mesa, which draws "
    "without a graphics card), or NVIDIA's with its EGL. The native world does not need it: leave "
    "out --world habitat"
)


def graphics_device() -> int:
    """The number of the device for ``SimulatorConfiguration.gpu_device_id``.

    Returns:
        The first CUDA device; `DEFAULT_DEVICE` if no device has CUDA. On systems other than
        Linux, where habitat-sim doesn't draw through EGL, its own default, 0.

    Raises:
        MissingExtraError: EGL is not installed, or has no device to draw with.
    """
    if sys.platform != "linux":
        return 0
    devices = egl_devices()
    if not devices:
        raise MissingExtraError(f"habitat-sim finds no device to draw with (EGL has 0); {_INSTALL}")
    return min((number for number in devices if number is not None), default=DEFAULT_DEVICE)


def egl_devices() -> list[int | None]:
    """The CUDA numbers of EGL's devices; None for a device without CUDA.

    Raises:
        MissingExtraError: EGL is not installed.
    """
    try:
        egl = ctypes.CDLL("libEGL.so.1")
    except OSError as error:
        raise MissingExtraError(f"habitat-sim draws through EGL ({error}); {_INSTALL}") from error
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    addresses = [
        egl.eglGetProcAddress(name) for name in (b"eglQueryDevicesEXT", b"eglQueryDeviceAttribEXT")
    ]
    if None in addresses:
        return []
    query_devices = ctypes.CFUNCTYPE(
        ctypes.c_uint, ctypes.c_int, ctypes.POINTER(ctypes.c_void_p), ctypes.POINTER(ctypes.c_int)
    )(addresses[0])
    query_attribute = ctypes.CFUNCTYPE(
        ctypes.c_uint, ctypes.c_void_p, ctypes.c_int, ctypes.POINTER(ctypes.c_ssize_t)
    )(addresses[1])
    found, count = (ctypes.c_void_p * _MOST_DEVICES)(), ctypes.c_int(0)
    if not query_devices(_MOST_DEVICES, found, ctypes.byref(count)):
        return []
    numbers: list[int | None] = []
    for device in found[: count.value]:
        number = ctypes.c_ssize_t(0)
        has_cuda = query_attribute(device, _CUDA_DEVICE, ctypes.byref(number))
        numbers.append(number.value if has_cuda else None)
    return numbers
