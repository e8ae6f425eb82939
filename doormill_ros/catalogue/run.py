"""What the catalogue holds of a run: its columns, in the database and in a file of columns alike."""

from __future__ import annotations

from dataclasses import dataclass

NO_VERSION = "none"  #: of a model, in runs whose bag tells of none


@dataclass(frozen=True)
class CataloguedRun:
    """A run of one door. SI units; poses in base_link; None for what the bag does not tell, or no finite number.

    Attributes:
        run_id, door_id: Names.
        cell: Host and namespace of the recorder; empty in bags of other recorders.
        software: What recorded it, see `software`; empty in bags of other recorders.
        recipe_version: In the recipe database.
        recipe_digest: SHA-256 of the recipe without who saved it when.
        robot_model: Name of the model that the targets were corrected with; empty without targets.
        model_version: Of it in the store of models; "none" where the bag tells of none.
        begun_ns, ended_ns: When recipe and result were recorded [ns since the epoch].
        success: Whether the door was milled; None when the recording stopped before the run ended.
        error_code, message: What it ended with.
        x, y, z, qx, qy, qz, qw: T_base_door that the targets follow.
        offset_y, offset_z, offset_rotation: From the door's nominal place [m, m, rad].
        residual: Of the edge points [m].
        cycle_time: Predicted [s].
        largest_correction, expected_error: Of the targets [m].
        picture_to_pose, pose_to_targets, targets_to_ready, request_to_ready: How long the stages took [s].
        measured: Whether somebody measured the milled door.
        worst_feature, deviation, tolerance: Of that measurement [m].
        bag: Its folder; empty once it is gone.
        bag_sha256, bag_bytes: See `BagContent`; empty and 0 while it is being recorded.
    """

    run_id: str
    door_id: str = ""
    cell: str = ""
    software: str = ""
    recipe_version: int = 0
    recipe_digest: str = ""
    robot_model: str = ""
    model_version: str = NO_VERSION
    begun_ns: int | None = None
    ended_ns: int | None = None
    success: bool | None = None
    error_code: int = 0
    message: str = ""
    x: float | None = None
    y: float | None = None
    z: float | None = None
    qx: float | None = None
    qy: float | None = None
    qz: float | None = None
    qw: float | None = None
    offset_y: float | None = None
    offset_z: float | None = None
    offset_rotation: float | None = None
    residual: float | None = None
    cycle_time: float | None = None
    largest_correction: float | None = None
    expected_error: float | None = None
    picture_to_pose: float | None = None
    pose_to_targets: float | None = None
    targets_to_ready: float | None = None
    request_to_ready: float | None = None
    measured: bool = False
    worst_feature: str = ""
    deviation: float | None = None
    tolerance: float | None = None
    bag: str = ""
    bag_sha256: str = ""
    bag_bytes: int = 0


@dataclass(frozen=True)
class CataloguedInspection:
    """That somebody measured the door of a run.

    Attributes:
        run_id: Which.
        inspection: Folder with inspection.yaml.
        inspected_ns: When [ns since the epoch].
    """

    run_id: str
    inspection: str
    inspected_ns: int


@dataclass(frozen=True)
class CatalogueRow:
    """A run with what became known of it later.

    Attributes:
        run: The run.
        inspection: Its latest, None without.
        kept: Why its bag is kept for ever; empty where nobody said so.
    """

    run: CataloguedRun
    inspection: CataloguedInspection | None = None
    kept: str = ""
