CREATE TABLE run (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    ended_utc TEXT,
    status TEXT NOT NULL,
    reason TEXT NOT NULL DEFAULT '',
    overruns INTEGER NOT NULL DEFAULT 0,
    name TEXT NOT NULL,
    recipe_name TEXT NOT NULL,
    recipe_text TEXT NOT NULL,
    rig_text TEXT NOT NULL,
    started_utc TEXT NOT NULL,
    simulated INTEGER NOT NULL CHECK (simulated IN (0, 1)),
    kind TEXT NOT NULL,
    worn TEXT NOT NULL DEFAULT '',
    seed INTEGER,
    software_version TEXT NOT NULL DEFAULT '',
    git_revision TEXT NOT NULL DEFAULT '',
    operator TEXT NOT NULL DEFAULT '',
    recipe_source TEXT NOT NULL DEFAULT '',
    rig_source TEXT NOT NULL DEFAULT '',
    recipe_sha256 TEXT NOT NULL,
    rig_sha256 TEXT NOT NULL,
    calibration_sha256 TEXT NOT NULL,
    rig_seconds REAL
);
CREATE TABLE metadata (
    key TEXT PRIMARY KEY,
    value TEXT NOT NULL
);
CREATE TABLE version (
    component TEXT PRIMARY KEY,
    version TEXT NOT NULL
);
CREATE TABLE session (
    session INTEGER PRIMARY KEY,
    origin_s REAL NOT NULL,
    started_utc TEXT NOT NULL,
    host TEXT NOT NULL,
    pid INTEGER NOT NULL,
    operator TEXT NOT NULL,
    software_version TEXT NOT NULL,
    git_revision TEXT NOT NULL,
    versions TEXT NOT NULL
);
CREATE TABLE change (
    id INTEGER PRIMARY KEY,
    session INTEGER NOT NULL,
    utc TEXT NOT NULL,
    subject TEXT NOT NULL,
    before_sha256 TEXT NOT NULL,
    after_sha256 TEXT NOT NULL,
    before TEXT NOT NULL,
    reason TEXT NOT NULL
);
CREATE TABLE calibration (
    id INTEGER PRIMARY KEY,
    session INTEGER NOT NULL,
    device TEXT NOT NULL,
    quantity TEXT NOT NULL,
    value TEXT NOT NULL,
    unit TEXT NOT NULL
);
CREATE TABLE material (
    id INTEGER PRIMARY KEY,
    file TEXT NOT NULL UNIQUE,
    role TEXT NOT NULL,
    name TEXT NOT NULL,
    source TEXT NOT NULL,
    sha256 TEXT NOT NULL,
    text TEXT,
    doubts TEXT NOT NULL DEFAULT ''
);
CREATE TABLE axis (
    position INTEGER PRIMARY KEY,
    name TEXT NOT NULL UNIQUE,
    recipe_unit TEXT NOT NULL,
    field TEXT NOT NULL UNIQUE,
    unit TEXT NOT NULL,
    scale REAL NOT NULL,
    column_name TEXT NOT NULL,
    header TEXT NOT NULL,
    title TEXT NOT NULL,
    word TEXT NOT NULL,
    default_value,
    paper INTEGER NOT NULL,
    plotted INTEGER NOT NULL,
    choices TEXT NOT NULL,
    blocks INTEGER NOT NULL
);
CREATE TABLE channel (
    position INTEGER PRIMARY KEY,
    name TEXT NOT NULL UNIQUE,
    unit TEXT NOT NULL,
    label TEXT NOT NULL,
    source TEXT NOT NULL,
    mean INTEGER NOT NULL,
    decimals INTEGER NOT NULL,
    whole INTEGER NOT NULL CHECK (whole IN (0, 1)),
    shown_name TEXT NOT NULL,
    shown_unit TEXT NOT NULL,
    scale REAL NOT NULL,
    role TEXT NOT NULL,
    block REAL,
    screen TEXT NOT NULL
);
CREATE TABLE budget_term (
    position INTEGER PRIMARY KEY,
    acts TEXT NOT NULL,
    bound REAL NOT NULL,
    factor REAL NOT NULL,
    df REAL,
    name TEXT NOT NULL,
    unit TEXT NOT NULL,
    distribution TEXT NOT NULL,
    source TEXT NOT NULL,
    channel TEXT NOT NULL DEFAULT '',
    common TEXT NOT NULL DEFAULT 'rig',
    setting TEXT NOT NULL DEFAULT '',
    factor_setting TEXT NOT NULL DEFAULT '',
    whole_at REAL
);
CREATE TABLE known_slope (
    position INTEGER PRIMARY KEY,
    temperature_c REAL NOT NULL,
    per_kelvin_percent REAL NOT NULL,
    u_per_kelvin_percent REAL NOT NULL,
    compound TEXT NOT NULL,
    source TEXT NOT NULL
);
CREATE TABLE specimen (
    specimen INTEGER PRIMARY KEY,
    compound TEXT NOT NULL,
    note TEXT NOT NULL DEFAULT ''
);
CREATE TABLE piece (
    piece INTEGER PRIMARY KEY,
    specimen INTEGER NOT NULL,
    replicate INTEGER NOT NULL,
    compound TEXT NOT NULL,
    installed_s REAL,
    installed_diameter_mm REAL,
    diameter_mm REAL,
    sliding_m REAL,
    updated_s REAL,
    ground_s REAL,
    hardness_shore_a REAL,
    hardness_by TEXT NOT NULL DEFAULT '',
    hardness_utc TEXT NOT NULL DEFAULT ''
);
CREATE TABLE wear_check (
    id INTEGER PRIMARY KEY,
    used INTEGER NOT NULL CHECK (used IN (0, 1)),
    piece INTEGER NOT NULL,
    method TEXT NOT NULL,
    t_s REAL,
    reference_s REAL,
    before INTEGER NOT NULL,
    after INTEGER NOT NULL,
    diameter_mm REAL,
    u_mm REAL,
    rubber_c REAL,
    u_growth_mm_k REAL,
    press_mm REAL,
    load_n REAL,
    sliding_m REAL,
    exposure_n_m REAL,
    width_mm REAL,
    u_rate_percent REAL,
    expected_mm REAL
);
CREATE TABLE travel (
    id INTEGER PRIMARY KEY,
    piece INTEGER NOT NULL,
    repeat_id INTEGER NOT NULL,
    counterface_m REAL,
    piece_m REAL,
    UNIQUE (piece, repeat_id)
);
CREATE TABLE condition (
    condition INTEGER PRIMARY KEY,
    compound TEXT NOT NULL,
    temperature_band_k REAL NOT NULL,
    status TEXT NOT NULL,
    reason TEXT NOT NULL DEFAULT '',
    row INTEGER NOT NULL,
    specimen INTEGER NOT NULL,
    replicate INTEGER NOT NULL,
    grid TEXT NOT NULL,
    note TEXT NOT NULL,
    repeats INTEGER NOT NULL,
    min_valid INTEGER NOT NULL,
    window_revolutions REAL,
    window_s REAL,
    at_most INTEGER NOT NULL DEFAULT 0,
    until_percent REAL,
    both_directions INTEGER NOT NULL CHECK (both_directions IN (0, 1)) DEFAULT 0,
    started_s REAL,
    ended_s REAL,
    warming_k_s REAL,
    holdable_band_k REAL,
    drift_percent REAL,
    drift_error_percent REAL,
    drift_bound_percent REAL,
    per_kelvin_percent REAL,
    repeat_windows REAL,
    trend_percent REAL,
    flags TEXT NOT NULL DEFAULT ''
);
CREATE TABLE soak (
    id INTEGER PRIMARY KEY,
    condition INTEGER NOT NULL,
    t_s REAL,
    surface_c REAL,
    model_c REAL,
    hub_c REAL,
    allowed_k REAL
);
CREATE TABLE repeat (
    id INTEGER PRIMARY KEY,
    condition INTEGER NOT NULL REFERENCES condition (condition),
    repeat INTEGER NOT NULL,
    attempt INTEGER NOT NULL,
    piece INTEGER NOT NULL,
    begun_s REAL,
    status TEXT NOT NULL,
    reason TEXT NOT NULL DEFAULT '',
    flags TEXT NOT NULL DEFAULT '',
    mu_resultant REAL,
    mu_longitudinal REAL,
    mu_lateral REAL,
    uncertainty REAL,
    fluctuation_percent REAL,
    batches INTEGER NOT NULL DEFAULT 0,
    drift_percent REAL,
    bound_percent REAL,
    change_percent REAL,
    swing_percent REAL,
    swing_hz REAL,
    swing_skewness REAL,
    revolutions INTEGER NOT NULL DEFAULT 0,
    truncated INTEGER NOT NULL DEFAULT 0,
    window_s REAL,
    bursts INTEGER NOT NULL DEFAULT 0,
    started_s REAL,
    ended_s REAL,
    UNIQUE (condition, repeat, attempt)
);
CREATE TABLE burst (
    repeat_id INTEGER NOT NULL REFERENCES repeat (id),
    number INTEGER NOT NULL,
    revolutions INTEGER NOT NULL,
    started_s REAL,
    ended_s REAL,
    surface_first_c REAL,
    surface_last_c REAL,
    PRIMARY KEY (repeat_id, number)
);
CREATE TABLE sample_block (
    id INTEGER PRIMARY KEY,
    repeat_id INTEGER NOT NULL,
    rows INTEGER NOT NULL,
    first_s REAL,
    last_s REAL,
    data BLOB NOT NULL
);
CREATE INDEX sample_block_repeat ON sample_block (repeat_id);
CREATE TABLE tare (
    id INTEGER PRIMARY KEY,
    t_s REAL,
    kind TEXT NOT NULL,
    repeat_id INTEGER NOT NULL
);
CREATE TABLE truth (
    id INTEGER PRIMARY KEY,
    condition INTEGER NOT NULL,
    repeat INTEGER NOT NULL,
    attempt INTEGER NOT NULL,
    name TEXT NOT NULL,
    value REAL
);
CREATE TABLE event (
    sequence INTEGER PRIMARY KEY,
    t_s REAL,
    utc TEXT NOT NULL,
    kind TEXT NOT NULL,
    severity TEXT NOT NULL,
    text TEXT NOT NULL,
    data TEXT NOT NULL
);
CREATE TABLE prompt (
    id INTEGER PRIMARY KEY,
    answered_utc TEXT,
    answer TEXT,
    answered_by TEXT,
    asked_s REAL,
    asked_utc TEXT NOT NULL,
    text TEXT NOT NULL,
    answered_s REAL
);
CREATE TABLE trip (
    id INTEGER PRIMARY KEY,
    acknowledged_utc TEXT,
    acknowledged_by TEXT,
    t_s REAL,
    utc TEXT NOT NULL,
    interlock TEXT NOT NULL,
    text TEXT NOT NULL,
    value REAL,
    limit_value REAL,
    unit TEXT NOT NULL,
    acknowledged_s REAL
);
CREATE TABLE bus_statistic (
    id INTEGER PRIMARY KEY,
    t_s REAL,
    bus TEXT NOT NULL,
    device TEXT NOT NULL,
    counter TEXT NOT NULL,
    value REAL
);
CREATE TABLE device_parameter (
    id INTEGER PRIMARY KEY,
    t_s REAL,
    device TEXT NOT NULL,
    parameter TEXT NOT NULL,
    name TEXT NOT NULL,
    value TEXT NOT NULL
);
CREATE TABLE exclusion (
    id INTEGER PRIMARY KEY,
    condition INTEGER NOT NULL REFERENCES condition (condition),
    excluded INTEGER NOT NULL CHECK (excluded IN (0, 1)),
    reason TEXT NOT NULL CHECK (reason <> ''),
    repeat INTEGER NOT NULL,
    attempt INTEGER NOT NULL,
    operator TEXT NOT NULL,
    utc TEXT NOT NULL,
    software_version TEXT NOT NULL,
    manifest_before TEXT NOT NULL
);
CREATE TRIGGER exclusion_is_not_changed BEFORE UPDATE ON exclusion
    BEGIN SELECT RAISE(ABORT, 'exclusions are only added'); END;
CREATE TRIGGER exclusion_is_not_deleted BEFORE DELETE ON exclusion
    BEGIN SELECT RAISE(ABORT, 'exclusions are only added'); END;
CREATE TABLE chain (
    seq INTEGER PRIMARY KEY,
    name TEXT NOT NULL,
    key INTEGER NOT NULL,
    row_sha256 BLOB NOT NULL,
    head BLOB NOT NULL
);
