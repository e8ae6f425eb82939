"""Every kind of feature by the name that recipes give it; a new kind is one file and one line here."""

from __future__ import annotations

from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.features.face_plate import FacePlate
from doormill_ros.recipes.features.handle_hole import HandleHole
from doormill_ros.recipes.features.hinge_pocket import LeafHinge, OblongHinge
from doormill_ros.recipes.features.lock_case import LockCase

FEATURES: dict[str, type[Feature]] = {
    feature.kind: feature for feature in (OblongHinge, LeafHinge, LockCase, FacePlate, HandleHole)
}
