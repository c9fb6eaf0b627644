use super::*;

const FOV: Fov = Fov { left: -0.8, right: 0.8, up: 0.8, down: -0.8 };
const MAP: MapShape = MapShape { extent: [64, 48], texel: [16, 16], tiles: [4, 3] };

fn params(view: DebugView) -> DebugViewParams {
    DebugViewParams::new(view, [0, 0], [64, 48], FOV, Vec3::NEG_Z, &MAP)
}

#[test]
fn a_rate_has_the_colour_of_its_share_and_full_rate_has_none() {
    let of = |rate: ShadingRate| of_rate(rate.texel());
    assert_eq!(of(ShadingRate::R1X1), None);
    assert_eq!(of(ShadingRate::R2X1), of(ShadingRate::R1X2));
    let colours = [ShadingRate::R2X1, ShadingRate::R2X2, ShadingRate::R4X2, ShadingRate::R4X4].map(of);
    for (index, colour) in colours.iter().enumerate() {
        assert!(colour.is_some() && !colours[..index].contains(colour), "{colours:?}");
    }
    // A skipped tile, and a byte that is not a rate.
    assert_eq!(of_rate(ShadingRate::R4X4.texel() | crate::reuse::STALE), of(ShadingRate::R4X4));
    assert_eq!(of_rate(0x0f), None);
}

#[test]
fn each_pixel_has_its_own_tile() {
    let mut map = vec![0; 12];
    map[4 + 2] = 3;
    let params = params(DebugView::Age);
    for y in 0..48 {
        for x in 0..64 {
            assert_eq!(params.pixel(x, y, &map).is_some(), [x / 16, y / 16] == [2, 1], "{x}, {y}");
        }
    }
}

#[test]
fn a_map_is_drawn_over_a_picture_of_another_size_and_the_other_way_up() {
    let mut map = vec![0; 12];
    map[3] = 1;
    let shows = |params: &DebugViewParams, x, y| params.pixel(x, y, &map).is_some();
    let half = DebugViewParams::new(DebugView::Age, [0, 0], [32, 24], FOV, Vec3::NEG_Z, &MAP);
    assert!(shows(&half, 24, 7) && !shows(&half, 23, 7) && !shows(&half, 24, 8));
    let flipped = Fov { up: FOV.down, down: FOV.up, ..FOV };
    let flipped = DebugViewParams::new(DebugView::Age, [0, 0], [64, 48], flipped, Vec3::NEG_Z, &MAP);
    assert!(shows(&flipped, 63, 47) && shows(&flipped, 63, 32) && !shows(&flipped, 63, 31));
}

#[test]
fn the_dot_is_at_the_gaze_alone() {
    let gaze = Vec3::new(0.3, 0.2, -1.0);
    let params = DebugViewParams::new(DebugView::Gaze, [0, 0], [640, 480], FOV, gaze, &MapShape::default());
    let (mut drawn, mut sum) = (0, Vec2::ZERO);
    for y in 0..480 {
        for x in 0..640 {
            if params.pixel(x, y, &[]).is_some() {
                drawn += 1;
                sum += Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            }
        }
    }
    let plane = FOV.tangents().plane([640, 480]);
    let expected = (gaze.truncate() - plane.origin) / plane.step;
    assert!(drawn > 20 && (sum / drawn as f32 - expected).length() < 1.0, "{drawn} around {sum}, {expected}");
    let unknown = DebugViewParams { gaze: [0.0; 3], ..params };
    assert!((0..480).all(|y| (0..640).all(|x| unknown.pixel(x, y, &[]).is_none())));
}

#[test]
fn angles_have_a_line_every_ten_degrees() {
    let is_line = |degrees| of_angle(degrees).1 == LINE;
    assert!([10.0, 10.1, 19.9, 50.0].into_iter().all(is_line));
    assert!(![0.0, 0.1, 5.0, 10.3, 45.0].into_iter().any(is_line));
    assert!(of_angle(5.0).0.y > of_angle(35.0).0.y && of_angle(35.0).0.x > of_angle(5.0).0.x);
}

#[test]
fn pixels_without_overlay_keep_their_bits_and_so_does_alpha() {
    let mut map = vec![0; 12];
    map[0] = 1;
    let before: Vec<u8> = (0..64 * 48 * 4u32).map(|byte| (byte * 31 % 251) as u8).collect();
    for format in [PixelFormat::Rgba8Srgb, PixelFormat::Bgra8Unorm] {
        let mut after = before.clone();
        debug_view_image(&mut after, 64, format, &params(DebugView::Age), &map);
        for (index, (before, after)) in before.chunks(4).zip(after.chunks(4)).enumerate() {
            assert_eq!(before[3], after[3]);
            assert_eq!(before != after, index % 64 < 16 && index / 64 < 16, "texel {index}");
        }
    }
}
