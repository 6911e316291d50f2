"""What each operation of the API needs: the list that `test_rights.py` walks, and fails on what is missing in it."""

from enum import Enum
from typing import Any

Json = dict[str, Any]


class Needs(Enum):
    """Who gets through. Everybody else is refused: 401 nobody, 404 who may not know of it, 403 who may."""

    NOTHING = "answers everybody"
    PERSON = "whoever is signed in, about what is theirs"
    ACCOUNT = "a person themselves: no visitor, no token but of the scope admin"
    VIEW = "view in the group"
    EDIT = "edit in the group"
    MEMBER = "a member of the group"
    EDIT_OWN = "whoever may change anything, about what is in their groups"
    GROUP = "a member of the group, or an administrator"
    GROUP_ACCOUNT = "the same, themselves"
    MANAGE_GROUP = "who manages the group, or an administrator"
    ADMINISTRATOR = "an administrator"


NEEDS = {
    "health_get": Needs.NOTHING,
    "schemas_get_experiment": Needs.NOTHING,
    "schemas_get_parameters": Needs.NOTHING,
    # /session, /account, /people
    "session_get": Needs.NOTHING,
    "session_create": Needs.NOTHING,
    "session_delete": Needs.NOTHING,
    "session_oidc": Needs.NOTHING,
    "session_oidc_callback": Needs.NOTHING,
    "invitations_look": Needs.NOTHING,
    "invitations_accept": Needs.NOTHING,
    "account_get": Needs.ACCOUNT,
    "account_update": Needs.ACCOUNT,
    "account_password": Needs.ACCOUNT,
    "account_sessions": Needs.ACCOUNT,
    "account_end_session": Needs.ACCOUNT,
    "people_list": Needs.ADMINISTRATOR,
    "people_create": Needs.ADMINISTRATOR,
    "people_update": Needs.ADMINISTRATOR,
    "people_link": Needs.ADMINISTRATOR,
    "tokens_list": Needs.ACCOUNT,
    "tokens_create": Needs.ACCOUNT,
    "tokens_revoke": Needs.ACCOUNT,
    "administration_get": Needs.ADMINISTRATOR,
    "audit_list": Needs.ADMINISTRATOR,
    # /groups
    "groups_list": Needs.PERSON,
    "groups_create": Needs.ACCOUNT,
    "groups_get": Needs.GROUP,
    "groups_update": Needs.MANAGE_GROUP,
    "groups_limit": Needs.ADMINISTRATOR,
    "groups_delete": Needs.MANAGE_GROUP,
    "members_list": Needs.GROUP,
    "members_set": Needs.MANAGE_GROUP,
    "members_remove": Needs.GROUP_ACCOUNT,  # the walk takes the one who asks out: everybody may leave
    "invitations_list": Needs.MANAGE_GROUP,
    "invitations_create": Needs.MANAGE_GROUP,
    "invitations_delete": Needs.MANAGE_GROUP,
    "webhooks_list": Needs.MANAGE_GROUP,
    "webhooks_create": Needs.MANAGE_GROUP,
    "webhooks_update": Needs.MANAGE_GROUP,
    "webhooks_delete": Needs.MANAGE_GROUP,
    "webhooks_renew_secret": Needs.MANAGE_GROUP,
    "webhooks_test": Needs.MANAGE_GROUP,
    "notices_list": Needs.MANAGE_GROUP,
    "notices_resend": Needs.MANAGE_GROUP,
    "presets_list": Needs.MEMBER,
    "presets_create": Needs.EDIT,
    "presets_update": Needs.EDIT,
    "presets_delete": Needs.EDIT,
    # /materials
    "materials_list": Needs.PERSON,
    "materials_get": Needs.PERSON,
    "materials_get_phase_diagram": Needs.PERSON,
    "materials_get_viscosity": Needs.PERSON,
    "ramps_get": Needs.PERSON,
    "ramps_download": Needs.PERSON,
    # /experiments
    "experiments_list": Needs.PERSON,
    "experiments_create": Needs.EDIT,
    "experiments_get": Needs.VIEW,
    "experiments_update": Needs.EDIT,
    "experiments_delete": Needs.EDIT,
    "experiments_move": Needs.EDIT,
    "experiments_events": Needs.VIEW,
    "files_list": Needs.VIEW,
    "files_upload": Needs.EDIT,
    "files_download": Needs.VIEW,
    "stack_complete": Needs.EDIT,
    "stack_delete": Needs.EDIT,
    "stack_confirm": Needs.EDIT,
    "frames_delete": Needs.EDIT,
    "trash_look": Needs.PERSON,
    "trash_empty": Needs.EDIT_OWN,
    "trash_restore_experiment": Needs.EDIT,
    "trash_remove_experiment": Needs.EDIT,
    "trash_restore_run": Needs.EDIT,
    "trash_remove_run": Needs.EDIT,
    "trash_restore_frames": Needs.EDIT,
    "trash_remove_frames": Needs.EDIT,
    "frames_picture": Needs.VIEW,
    "clock_get": Needs.VIEW,
    "imports_look": Needs.EDIT,
    "imports_create": Needs.EDIT,
    "uploads_plan": Needs.EDIT,
    "uploads_create": Needs.EDIT,
    "uploads_list": Needs.VIEW,
    "uploads_get": Needs.VIEW,
    "uploads_offset": Needs.EDIT,
    "uploads_send": Needs.EDIT,
    "uploads_terminate": Needs.EDIT,
    "previews_create": Needs.EDIT,
    "link_previews_create": Needs.EDIT,
    "suggestions_create": Needs.EDIT,
    # /runs
    "runs_list": Needs.VIEW,
    "runs_list_all": Needs.PERSON,
    "runs_create": Needs.EDIT,
    "runs_get": Needs.VIEW,
    "runs_get_reuse": Needs.VIEW,
    "runs_cancel": Needs.EDIT,
    "runs_retry": Needs.EDIT,
    "runs_delete": Needs.EDIT,
    "runs_events": Needs.VIEW,
    "shares_list": Needs.EDIT,
    "shares_create": Needs.EDIT,
    "shares_delete": Needs.EDIT,
    "figures_list": Needs.VIEW,
    "figures_get": Needs.VIEW,
    "figures_table": Needs.VIEW,
    "droplets_get": Needs.VIEW,
    "flow_get": Needs.VIEW,
    "tails_get": Needs.VIEW,
    "trajectories_get": Needs.VIEW,
    "detections_get": Needs.VIEW,
    "prepared_frames_get": Needs.VIEW,
    "flow_maps_get": Needs.VIEW,
    "quality_get": Needs.VIEW,
    "report_get": Needs.VIEW,
    "exports_list": Needs.VIEW,
    "exports_get": Needs.VIEW,
    "result_files_list": Needs.VIEW,
    "result_files_download": Needs.VIEW,
    # /compare
    "comparison_get": Needs.VIEW,
    "comparison_figures_get": Needs.VIEW,
    "comparison_figures_table": Needs.VIEW,
}
"""By operation id. A new operation stands here, or the tests fail."""

_WRONG_KNOB = {"json": {"frame": 0, "parameters": {"detection": {"radius_min_um": -1}}}}
BODIES: dict[str, Json] = {
    "previews_create": _WRONG_KNOB,  # a right one would wait for a worker
    "link_previews_create": _WRONG_KNOB,
    "ramps_get": {"params": {"duration_s": 600}},
    "ramps_download": {"params": {"duration_s": 600}},
    "comparison_get": {"params": {"run": "{run_id}"}},
    "comparison_figures_get": {"params": {"run": "{run_id}"}},
    "comparison_figures_table": {"params": {"run": "{run_id}"}},
    "files_upload": {"params": {"name": "a.tif"}, "content": b"II*\0" + bytes(600)},
    "uploads_create": {
        "headers": {"Tus-Resumable": "1.0.0", "Upload-Length": "9", "Upload-Metadata": "filename YS50aWY="}
    },
    "uploads_offset": {"headers": {"Tus-Resumable": "1.0.0"}},
    "uploads_send": {
        "headers": {
            "Tus-Resumable": "1.0.0",
            "Upload-Offset": "0",
            "Content-Type": "application/offset+octet-stream",
        },
        "content": b"II*\0",
    },
}
"""What to send where the example in the OpenAPI document does not do; `{run_id}` in a parameter is that of the walk."""

_MIXTURE = {"name": "water-isobutoxyethanol-illustrative"}
VALUES: dict[str, dict[str, str]] = {
    "materials_get": _MIXTURE,
    "materials_get_phase_diagram": _MIXTURE,
    "materials_get_viscosity": _MIXTURE,
    "ramps_get": _MIXTURE,
    "ramps_download": _MIXTURE,
    "figures_get": {"name": "moments"},
    "figures_table": {"name": "moments"},
    "comparison_figures_get": {"name": "moments"},
    "comparison_figures_table": {"name": "moments"},
    "exports_get": {"kind": "csv"},
    "result_files_download": {"name": "summary.json"},
    "frames_picture": {"kind": "webp"},
    "trajectories_get": {"trajectory_id": "0"},
}
"""What stands in the path of an operation beside ids and numbers of frames."""
