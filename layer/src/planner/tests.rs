use super::*;
use crate::config::{ChromaMode, Preset, RatesBackend, RatesGate, RatesMode, ReuseMode, SilenceRule};
use crate::inputs::gaze::auto::{PacketDelay, SampleTimes};
use crate::inputs::gaze::osc::{NewestGaze, OscGaze, read};
use crate::kernels::debug_view::DebugView;
use crate::link::{BACKEND_RATE_ATTACHMENT, CapabilitiesRecord, EyeMapRecord};
use parafovea_core::geometry::Fov;
use parafovea_core::rate::{ShadingRate, VULKAN_RATES};

/// 90 Hz.
const FRAME_NS: i64 = 11_111_111;

fn capabilities(rates: &[ShadingRate], texel: [u32; 2]) -> Capabilities {
    let mut record = CapabilitiesRecord {
        backend: BACKEND_RATE_ATTACHMENT,
        texel,
        rate_count: rates.len() as u32,
        rates: [0; 16],
        is_cpu: 0,
    };
    for (to, rate) in record.rates.iter_mut().zip(rates) {
        *to = rate.texel();
    }
    Capabilities::from(&record)
}

/// A session with two views of 90 by 90 degrees that are canted outwards, as an application shows them.
struct Session {
    planner: SessionPlanner,
    config: Config,
    serial: u64,
    time_ns: i64,
    head: Quat,
}

impl Session {
    fn new(config: Config) -> Self {
        Self::on(capabilities(&VULKAN_RATES, [16, 16]), config)
    }

    /// On a device with these capabilities.
    fn on(capabilities: Capabilities, mut config: Config) -> Self {
        // Rings are known here, rates by contrast to the GPU alone.
        if config.rates.mode == RatesMode::Auto {
            config.rates.mode = RatesMode::Fixed;
        }
        let mut planner = SessionPlanner::new(capabilities);
        let edge = std::f32::consts::FRAC_PI_4;
        let fov = Fov { left: -edge, right: edge, up: edge, down: -edge };
        let views = [0.1, -0.1].map(|cant| View {
            orientation: Quat::from_rotation_y(cant),
            position: Vec3::X * (-0.32 * cant),
            fov,
        });
        planner.views.located(&views);
        planner.views.shown(Some(1), &views.map(|view| ShownView { view, extent: [512, 512] }));
        Self { planner, config, serial: 0, time_ns: 0, head: Quat::IDENTITY }
    }

    fn begin(&mut self) {
        self.time_ns += FRAME_NS;
        self.planner.frame_begins(self.time_ns, 1);
    }

    /// Plans the frame with that gaze. Returns whether the rates changed.
    fn plan(&mut self, look: Look) -> bool {
        self.planner.look(&self.config, look, self.head, self.time_ns);
        assert!(self.planner.plan(&self.config, true, self.head, self.time_ns));
        let (planner, serial) = (&mut self.planner, &mut self.serial);
        let record = planner.new_rates(&self.config, || {
            *serial += 1;
            *serial
        });
        record.is_some()
    }

    fn frame(&mut self, look: Look) -> bool {
        self.begin();
        self.plan(look)
    }

    fn frames(&mut self, count: usize, look: Look) {
        for _ in 0..count {
            self.frame(look);
        }
    }

    /// The part of the tiles of an eye that have full rate.
    fn full(&self, eye: usize) -> f32 {
        let rates = self.rates(eye);
        rates.iter().filter(|rate| **rate == 0).count() as f32 / rates.len() as f32
    }

    fn rates(&self, eye: usize) -> &[u8] {
        self.planner.planner.as_ref().unwrap().newest().eyes[eye].rates.texels()
    }
}

/// A packet of one message with these numbers.
fn packet(address: &str, numbers: &[f32]) -> Vec<u8> {
    let args = numbers.iter().map(|number| rosc::OscType::Float(*number)).collect();
    rosc::encoder::encode(&rosc::OscPacket::Message(rosc::OscMessage { addr: address.to_owned(), args }))
        .unwrap()
}

/// Packets of each format for a gaze to the left and up, degrees.
fn said([left, up]: [f32; 2]) -> Vec<Vec<Vec<u8>>> {
    let Vec3 { x, y, z } = crate::inputs::gaze::direction([left, up]);
    let [right, share_up] = [-left / 45.0, up / 45.0];
    let of_eyes = |name: fn(&str, &str) -> String| {
        let axes = [("X", right), ("Y", share_up)];
        let both = ["Left", "Right"].map(|eye| axes.map(|(axis, share)| packet(&name(eye, axis), &[share])));
        both.concat()
    };
    vec![
        vec![packet("/tracking/eye/CenterPitchYaw", &[-up, -left])],
        vec![packet("/tracking/eye/CenterPitchYawDist", &[-up, -left, 2.0])],
        vec![packet("/tracking/eye/LeftRightPitchYaw", &[-up, -left, -up, -left])],
        vec![packet("/tracking/eye/CenterVec", &[x, y, -z])],
        vec![packet("/tracking/eye/CenterVecFull", &[2.0 * x, 2.0 * y, -2.0 * z])],
        vec![packet("/tracking/eye/LeftRightVec", &[x, y, -z, x, y, -z])],
        of_eyes(|eye, axis| format!("/avatar/parameters/FT/v2/Eye{eye}{axis}")),
        of_eyes(|eye, axis| format!("/{eye}Eye{axis}")),
    ]
}

/// The rate of an eye's tile in a direction.
fn rate_at(session: &Session, eye: usize, direction: Vec3) -> u8 {
    let seen = session.planner.views.orientation(eye).inverse() * direction;
    let tile = |tangent: f32| ((1.0 + tangent) / 2.0 * 32.0) as usize;
    session.rates(eye)[32 * tile(seen.y / seen.z) + tile(-seen.x / seen.z)]
}

#[test]
fn a_gaze_in_packets_is_in_the_map_of_the_next_frame() {
    let sender = std::net::SocketAddr::from(([127, 0, 0, 1], 9));
    let (from, to) = ([25.0, 0.0], [-25.0, 10.0]);
    for (format, (here, there)) in said(from).iter().zip(said(to)).enumerate() {
        let mut config = Config::of_preset(Preset::Balanced);
        config.gaze.source = GazeSource::Osc;
        let mut session = Session::new(config);
        let (mut gaze, mut times) = (OscGaze::new(45.0), SampleTimes::default());
        for frame in 0..61 {
            // Packets come 2 ms before the frame is planned. The last ones are elsewhere.
            let came_ns = session.time_ns + FRAME_NS - 2_000_000;
            let packets = if frame < 60 { here } else { &there };
            packets.iter().for_each(|bytes| gaze.take(sender, read(bytes), came_ns));
            session.begin();
            let newest = NewestGaze { look: gaze.look(), age: Some(std::time::Duration::from_millis(2)) };
            session.plan(newest.look(&mut times, session.time_ns, PacketDelay::ASSUMED));
            let [is_here, is_there] = [from, to].map(crate::inputs::gaze::direction).map(|direction| {
                [0, 1].map(|eye| rate_at(&session, eye, direction) == ShadingRate::R1X1.texel())
            });
            if frame > 30 {
                let expected = ([true; 2], [frame == 60; 2]);
                assert_eq!((is_here, is_there), expected, "format {format}, frame {frame}");
            }
        }
    }
}

fn centre(preset: Preset) -> Config {
    let mut config = Config::of_preset(preset);
    config.gaze.source = GazeSource::Centre;
    config
}

fn yaw(degrees: f32) -> Look {
    Look::At {
        direction: Quat::from_rotation_y(degrees.to_radians()) * Vec3::NEG_Z,
        sampled_ns: 0,
        uncertainty_ns: 0,
    }
}

#[test]
fn the_centre_gives_one_map_from_the_first_frame_on() {
    let mut session = Session::new(centre(Preset::Balanced));
    assert!(session.frame(Look::NoTracker), "the first is news");
    let first = session.rates(0).to_vec();
    assert!(first.contains(&ShadingRate::R4X4.texel()) && first.contains(&ShadingRate::R1X1.texel()));
    for _ in 0..100 {
        assert!(!session.frame(Look::NoTracker));
        assert_eq!(session.rates(0), first);
    }
}

#[test]
fn a_gaze_that_rests_comes_to_one_map() {
    let mut session = Session::new(Config::default());
    session.frames(90, yaw(10.0));
    let serial = session.serial;
    session.frames(90, yaw(10.0));
    assert_eq!(session.serial, serial);
    session.frames(1, yaw(-10.0));
    assert_eq!(session.serial, serial + 1, "until it moves");
}

/// A tracker whose exposures are not all usable.
#[test]
fn rates_become_coarse_although_samples_are_lost_one_at_a_time() {
    let [mut losing, mut whole] = [(); 2].map(|()| Session::new(Config::default()));
    for frame in 0..180 {
        losing.frame(if frame % 5 == 4 { Look::Unseen } else { yaw(10.0) });
        whole.frame(yaw(10.0));
    }
    assert!(whole.full(0) < 0.5, "{}", whole.full(0));
    assert!(losing.full(0) < whole.full(0) + 0.02, "{} {}", losing.full(0), whole.full(0));
}

#[test]
fn a_gaze_that_moves_within_a_frame_is_refined_at_once() {
    let mut session = Session::new(Config::default());
    session.frames(90, yaw(30.0));
    session.begin();
    session.plan(yaw(30.0));
    let right_edge = session.rates(1).len() / 2 + 31;
    assert_eq!(session.rates(1)[right_edge], ShadingRate::R4X4.texel());
    assert!(session.plan(yaw(-40.0)), "another map in the same frame");
    assert_eq!(session.rates(1)[right_edge], ShadingRate::R1X1.texel());
}

#[test]
fn both_eyes_give_one_direction_the_same_rate() {
    let mut session = Session::new(centre(Preset::Balanced));
    session.frame(Look::NoTracker);
    let mirrored: Vec<u8> = session.rates(0).chunks(32).flat_map(|row| row.iter().rev().copied()).collect();
    assert_eq!(session.rates(1), mirrored, "views that mirror each other have maps that do");
}

#[test]
fn without_a_tracker_rates_fall_off_widely_from_straight_ahead() {
    let mut session = Session::new(Config::default());
    session.frames(90, Look::NoTracker);
    let mut centre = Session::new(centre(Preset::Balanced));
    centre.frame(Look::NoTracker);
    assert!(session.full(0) > 2.0 * centre.full(0), "{} {}", session.full(0), centre.full(0));
    assert!(session.full(0) < 0.95, "{}", session.full(0));
    assert!(session.rates(0).iter().all(|rate| *rate <= ShadingRate::R2X2.texel()));
    assert!(session.planner.focus(0).is_none(), "colour needs a gaze");
}

#[test]
fn a_blink_holds_the_map_and_a_lost_gaze_ends_in_wide_rates() {
    let mut config = Config::of_preset(Preset::Streaming);
    config.gaze.hold_ms = 100;
    let mut session = Session::new(config);
    session.frames(90, yaw(0.0));
    let (full, serial) = (session.full(0), session.serial);
    session.frames(8, Look::Unseen);
    assert_eq!(session.serial, serial, "within 100 ms");
    assert!(session.planner.focus(0).is_some());
    session.frames(4, Look::Unseen);
    assert!(session.full(0) > full);
    assert!(session.planner.focus(0).is_none());
    session.frames(200, Look::Unseen);
    let lost = session.full(0);
    assert!(lost > full && lost < 0.95, "{full} {lost}");
}

#[test]
fn plans_have_the_tiles_and_the_rates_of_the_device() {
    let capabilities = capabilities(&[ShadingRate::R2X2, ShadingRate::R1X1], [8, 8]);
    let mut session = Session::on(capabilities, centre(Preset::Balanced));
    session.begin();
    session.planner.plan(&session.config, true, Quat::IDENTITY, session.time_ns);
    let record = session.planner.new_rates(&session.config, || 7).unwrap();
    assert_eq!(record.serial, 7);
    for EyeMapRecord { extent, texel, tiles, rates, is_decided, .. } in record.eyes {
        assert_eq!(is_decided, 0, "rings need no GPU");
        assert_eq!((extent, texel, tiles), ([512, 512], [8, 8], [64, 64]));
        assert!(!rates.is_null());
    }
    let coarsest = session.rates(0).iter().max().copied();
    assert_eq!(coarsest, Some(ShadingRate::R2X2.texel()));
}

/// Sound as loud as it gets, then none.
#[test]
fn contrast_and_sound_are_left_to_the_gpu() {
    let mut config = Config::default();
    config.gaze.source = GazeSource::Centre;
    config.rates.mode = RatesMode::AudioVisual;
    config.rates.silence = SilenceRule::Fixed;
    let greatest_loss = config.rates.greatest_loss;
    let mut session = Session::new(config);
    let loud = AudioFeatures { loudness_lufs: -10.0, gamma_ld: 25.0, gamma_fq_kilomel: 1.0, silent: false };
    let mut decided = |sound| {
        session.planner.listen(sound);
        session.begin();
        session.planner.plan(&session.config, true, Quat::from_rotation_y(0.3), session.time_ns);
        session.planner.new_rates(&session.config, || 1).unwrap().eyes[0]
    };
    let eye = decided(Some(loud));
    assert_eq!((eye.is_decided, eye.is_judged), (1, 1));
    assert_eq!(eye.judged.budget, greatest_loss, "as configured");
    assert_eq!((eye.fixed.sensitivity, eye.judged.sensitivity), (0, 1));
    assert_eq!(eye.judged.tiles, eye.tiles);
    assert!(eye.judged.full_rate_period > 0, "coarse tiles have frames at full rate");
    let turned = Quat::from_array(eye.orientation).angle_between(Quat::from_rotation_y(0.4));
    assert!(turned < 1e-3, "the left display is turned against the head, which is turned");
    let eye = decided(Some(AudioFeatures::SILENT));
    assert_eq!((eye.is_decided, eye.is_judged), (1, 0), "rings");
    session.config.rates.mode = RatesMode::Paper;
    let eye = {
        session.planner.listen(Some(loud));
        session.begin();
        session.planner.plan(&session.config, true, Quat::IDENTITY, session.time_ns);
        session.planner.new_rates(&session.config, || 1).unwrap().eyes[0]
    };
    assert_eq!(eye.judged.sensitivity, 2);
    assert!(eye.judged.budget > 50_000.0, "{}", eye.judged.budget);
}

#[test]
fn nothing_is_planned_for_what_is_off_or_not_there() {
    let session = Session::new(Config::default());
    assert!(session.planner.has_work(&session.config, true));
    let mut session = Session::on(Capabilities::default(), Config::default());
    assert!(!session.planner.has_work(&session.config, true), "no backend, no chroma");
    session.config.chroma.mode = ChromaMode::Default;
    assert!(session.planner.has_work(&session.config, true));
    assert!(!session.planner.has_work(&session.config, false), "chroma cannot be done");
    assert!(!session.frame(yaw(0.0)), "chroma needs a plan, but no rates are handed over");
    assert!(session.planner.focus(1).is_some());
    for off in [RatesBackend::Off, RatesBackend::Auto] {
        let mut config = Config::default();
        config.rates.backend = off;
        config.enabled = off == RatesBackend::Off;
        assert!(!wants_maps(&config));
    }
}

/// From the beginning of a trial on rates are planned, so that they are coarse when they are tried.
#[test]
fn maps_are_planned_while_a_technique_is_on_or_on_trial() {
    let off = Techniques { rates: false, reuse: false };
    let mut session = Session::new(Config::default());
    for (techniques, wants_costs) in [(Techniques { rates: true, reuse: false }, false), (off, true)] {
        session.planner.set_techniques(techniques, wants_costs);
        assert!(session.planner.has_work(&session.config, true));
        assert!(!session.planner.only_watches(&session.config, true));
    }
    session.planner.set_techniques(off, false);
    assert!(!session.planner.has_work(&session.config, true));
    assert!(session.planner.only_watches(&session.config, true));
    session.config.rates.gate = RatesGate::Off;
    assert!(!session.planner.only_watches(&session.config, true), "there will be no trial");
    session.config.chroma.mode = ChromaMode::Default;
    assert!(session.planner.has_work(&session.config, true), "chroma has no gate");
}

#[test]
fn rates_that_were_off_for_a_while_are_handed_over_again() {
    let mut session = Session::new(centre(Preset::Balanced));
    assert!(session.frame(Look::NoTracker));
    session.begin();
    session.planner.idle();
    assert!(!session.planner.is_planned());
    assert!(session.frame(Look::NoTracker));
}

#[test]
fn colour_that_was_there_goes_by_degrees() {
    let mut session = Session::new(centre(Preset::Streaming));
    session.frame(Look::NoTracker);
    assert_eq!(session.planner.focus(0).unwrap().0.strength, 1.0, "nothing was shown before");
    session.begin();
    session.planner.idle();
    session.frame(Look::NoTracker);
    assert!(session.planner.focus(0).unwrap().0.strength < 0.1);
}

#[test]
fn the_focus_is_where_the_eyes_look_from_the_head() {
    let mut session = Session::new(Config::of_preset(Preset::Streaming));
    session.frames(30, yaw(20.0));
    let Look::At { direction, .. } = yaw(20.0) else { panic!() };
    for eye in 0..2 {
        let (focus, _) = session.planner.focus(eye).unwrap();
        assert!(focus.direction.abs_diff_eq(direction, 1e-5), "{eye}: {focus:?}");
    }
}

/// They turn in the head, and not in the world.
#[test]
fn eyes_that_rest_while_the_head_turns_are_in_no_pursuit() {
    let mut session = Session::new(Config::of_preset(Preset::Balanced));
    let turned = |degrees: f32| Quat::from_rotation_y(degrees.to_radians());
    let ahead = |degrees: f32| turned(degrees).inverse() * Vec3::NEG_Z;
    for step in 0..120 {
        session.head = turned(0.5 * step as f32 - 30.0);
        session.begin();
        let direction = ahead(0.5 * step as f32 - 30.0);
        session.plan(Look::At { direction, sampled_ns: session.time_ns, uncertainty_ns: 0 });
        let gaze = session.planner.phase(&session.config, session.time_ns);
        assert!(step < 20 || gaze == GazePhase::Fixation, "step {step}: {gaze:?}");
    }
}

#[test]
fn a_thread_that_is_behind_does_not_undo_a_later_plan() {
    let mut session = Session::new(centre(Preset::Balanced));
    session.time_ns = 5 * LONGEST_STEP_BACK_NS;
    session.frame(Look::NoTracker);
    let mut plan = |time_ns| session.planner.plan(&session.config, true, Quat::IDENTITY, time_ns);
    let now = session.time_ns;
    assert!(!plan(now - FRAME_NS));
    assert!(plan(now));
    assert!(plan(now - 2 * LONGEST_STEP_BACK_NS), "but a clock may start anew");
}

#[test]
fn a_frame_has_a_plan_once_there_are_views() {
    let mut session = Session::new(centre(Preset::Balanced));
    let views = std::mem::take(&mut session.planner.views);
    session.begin();
    assert!(!session.planner.plan(&session.config, true, Quat::IDENTITY, session.time_ns));
    assert!(!session.planner.is_planned());
    session.planner.views = views;
    session.plan(Look::NoTracker);
    assert!(session.planner.is_planned());
    session.begin();
    assert!(!session.planner.is_planned());
}

/// The share of both eyes' tiles that the newest plan renders.
fn rendered(session: &Session) -> f32 {
    let plan = session.planner.planner.as_ref().unwrap().newest();
    let tiles = || plan.eyes.iter().flat_map(|eye| eye.ages.texels());
    tiles().filter(|age| **age == 0).count() as f32 / tiles().count() as f32
}

#[test]
fn only_what_is_kept_is_not_rendered_again() {
    for mode in [ReuseMode::On, ReuseMode::Paper] {
        let mut config = centre(Preset::Balanced);
        config.reuse.mode = mode;
        let mut session = Session::new(config);
        // Long enough for the frame rate to be known.
        for _ in 0..120 {
            session.frame(Look::NoTracker);
            assert_eq!(rendered(&session), 1.0, "{mode:?}: nobody keeps a picture");
        }
        let mut least = 1.0f32;
        for _ in 0..12 {
            session.planner.history_kept(0);
            session.planner.history_kept(1);
            assert!(session.frame(Look::NoTracker), "each frame has its own map");
            assert!(!session.plan(Look::NoTracker), "the same frame has the same");
            least = least.min(rendered(&session));
        }
        assert!(least < 0.6, "{mode:?}: {least}");
        session.planner.history_kept(0);
        session.frame(Look::NoTracker);
        let plan = session.planner.planner.as_ref().unwrap().newest();
        assert!(plan.eyes[1].ages.texels().iter().all(|age| *age == 0), "{mode:?}: the right eye has none");
        for pause_ns in [200_000_000, -FRAME_NS * 3] {
            for _ in 0..3 {
                session.planner.history_kept(0);
                session.planner.history_kept(1);
                session.frame(Look::NoTracker);
            }
            session.planner.history_kept(0);
            session.planner.history_kept(1);
            session.time_ns += pause_ns;
            session.begin();
            assert_eq!(
                session.planner.has_history, [false; 2],
                "{mode:?}: after a pause, or as the clock begins anew"
            );
        }
    }
}

#[test]
fn the_turn_of_the_head_is_known_for_the_newest_time_alone() {
    let mut planner = SessionPlanner::new(Capabilities::default());
    let config = Config::default();
    assert_eq!(planner.head_at(0), None);
    let [first, second] = [0.1, 0.2].map(Quat::from_rotation_y);
    planner.look(&config, Look::NoTracker, first, FRAME_NS);
    planner.look(&config, Look::NoTracker, second, 2 * FRAME_NS);
    assert_eq!([FRAME_NS, 2 * FRAME_NS].map(|time_ns| planner.head_at(time_ns)), [None, Some(second)]);
}

#[test]
fn the_dot_ahead_is_at_its_angles_from_the_head_in_both_views() {
    let mut session = Session::new(Config::default());
    session.frame(Look::NoTracker);
    for dot_deg in [[0.0, 0.0], [12.0, -9.0]] {
        for (eye, cant) in [0.1, -0.1].into_iter().enumerate() {
            let overlay = session
                .planner
                .seen(&session.config, eye, DebugView::Ahead, dot_deg, &mut Vec::new())
                .unwrap();
            let from_head = Quat::from_rotation_y(cant) * overlay.gaze;
            assert!(from_head.abs_diff_eq(crate::inputs::gaze::direction(dot_deg), 1e-5), "{from_head}");
        }
    }
}
