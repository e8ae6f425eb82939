"""Why a picture gives no pose.

LocalizationError
|-- 201 NoEdge             nothing straight where a door edge must be
|-- 202 WrongEdge          straight, but not the two edges of the door's face
|-- 203 TooFewInliers      too little of the edges agrees with a line
|-- 204 OutOfRange         the door stands further off than the cell accepts
|-- 205 Blurred            edges too soft to measure
|-- 206 OverExposed        the picture is clipped at white
|-- 207 UnderExposed       the picture is black
|-- 208 StalePicture       taken too long ago
|-- 209 CameraInfoMissing  no intrinsics with the picture
|-- 210 CameraInfoSize     intrinsics of another picture size
|-- 211 BadPicture         not a grey picture of 8 bits
`-- 212 BadCameraFile      camera.yaml cannot be read
"""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class LocalizationError(DoormillError):
    """Base of every reason why there is no door pose."""

    code = 200


class NoEdge(LocalizationError):
    """Nothing straight stands where a door edge must be."""

    code = 201


class WrongEdge(LocalizationError):
    """Lines were found that are not the two edges of the door's face."""

    code = 202


class TooFewInliers(LocalizationError):
    """Too small a part of an edge agrees with its line."""

    code = 203


class OutOfRange(LocalizationError):
    """The door stands further from its nominal place than the cell accepts."""

    code = 204


class Blurred(LocalizationError):
    """The edges are too soft to be measured."""

    code = 205


class OverExposed(LocalizationError):
    """Too much of the picture is clipped at white."""

    code = 206


class UnderExposed(LocalizationError):
    """The picture is too dark to hold an edge."""

    code = 207


class StalePicture(LocalizationError):
    """The picture was taken too long ago."""

    code = 208


class CameraInfoMissing(LocalizationError):
    """No camera intrinsics came with the picture."""

    code = 209


class CameraInfoSize(LocalizationError):
    """The intrinsics belong to a picture of another size."""

    code = 210


class BadPicture(LocalizationError):
    """Not a picture of shape (h, w) and type uint8."""

    code = 211


class BadCameraFile(LocalizationError):
    """The camera file lacks a key or holds a value out of bounds."""

    code = 212
