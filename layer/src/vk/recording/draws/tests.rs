use super::*;
use crate::pass_detection::ImageKey;

#[test]
fn quads_are_at_most_two_triangles_for_each_eye() {
    let quads = |vertices, instances| Counts::of(vertices, instances).quads;
    assert_eq!([quads(3, 1), quads(6, 2), quads(4, 1)], [1, 1, 1]);
    assert_eq!([quads(7, 1), quads(6, 3), quads(300, 1)], [0, 0, 0]);
    assert_eq!(Counts::of(u32::MAX, 3).vertices, u32::MAX);
    assert_eq!(Counts::of(36, 10), Counts { quads: 0, meshes: 1, vertices: 360 });
}

#[test]
fn a_thread_counts_for_the_pass_that_it_records_alone() {
    let [this, other] = [1, 2].map(vk::CommandBuffer::from_raw);
    let more = Counts::of(3, 1);
    assert_eq!(count(this, more), Counted::Elsewhere, "no pass");
    OPEN.with(|open| open.handle.set(1));
    assert_eq!([count(this, more), count(this, Counts::INDIRECT)], [Counted::Done; 2]);
    assert_eq!(count(other, more), Counted::Elsewhere);
    let counts = OPEN.with(|open| open.counts.replace(Counts::default()));
    assert_eq!(counts, Counts { quads: 1, meshes: 1, vertices: 3 + Draws::INDIRECT_VERTICES });
    let elsewhere = std::thread::spawn(move || count(this, more)).join().unwrap();
    assert_eq!(elsewhere, Counted::Elsewhere, "another thread");
}

#[test]
fn draws_of_untracked_commands_need_no_look_up() {
    let [tracked, untracked] = [5, 6].map(vk::CommandBuffer::from_raw);
    let more = Counts::of(3, 1);
    OPEN.with(|open| {
        open.handle.set(5);
        open.forget_bound(5, true);
    });
    assert_eq!(count(tracked, more), Counted::ReadsNotNoted);
    untracked_begins(untracked);
    assert_eq!([count(untracked, more), count(tracked, more)], [Counted::Done, Counted::Elsewhere]);
}

#[test]
fn bound_sets_are_noted_once_per_kind_of_draw() {
    let this = vk::CommandBuffer::from_raw(3);
    let [quad, mesh] = [Counts::of(3, 1), Counts::of(30, 1)];
    OPEN.with(|open| {
        open.handle.set(3);
        open.forget_bound(3, false);
        assert_eq!(count(this, quad), Counted::Done, "nothing is bound");
        open.sets[2].set(77);
        open.is_bound_anew(true);
        assert_eq!([count(this, quad), count(this, mesh)], [Counted::ReadsNotNoted; 2]);
        open.noted[0].set(true);
        assert_eq!([count(this, quad), count(this, mesh)], [Counted::Done, Counted::ReadsNotNoted]);
        // The next pass goes on with it.
        open.draws_in(3);
        assert_eq!(count(this, quad), Counted::ReadsNotNoted);
        open.draws_in(4);
        assert!(open.is_unknown.get(), "of another command buffer nobody saw what is bound");
    });
}

/// An upload is recorded beside a frame.
#[test]
fn sets_stay_bound_while_the_thread_records_another_command_buffer() {
    let (this, mesh) = (vk::CommandBuffer::from_raw(11), Counts::of(30, 1));
    let bound = |open: &Open| (open.bound_in.get(), open.sets[0].get(), open.is_unknown.get());
    OPEN.with(|open| {
        open.forget_bound(11, false);
        open.sets[0].set(77);
        open.is_bound_anew(true);
        open.draws_in(11);
        open.noted[1].set(true);
        open.forget_bound(12, false);
        assert_eq!(
            count(this, mesh),
            Counted::ReadsNotNoted,
            "the bound sets differ from the sets of the pass"
        );
        open.sets[0].set(78);
        open.is_bound_anew(true);
        assert_eq!(count(this, mesh), Counted::ReadsNotNoted);
        open.turn_to(11);
        assert_eq!(bound(open), (11, 77, false));
        open.turn_to(12);
        assert_eq!(bound(open), (12, 78, false));
        open.forget_bound(13, false);
        open.turn_to(11);
        assert_eq!(bound(open), (11, 0, true), "of three, the thread knows two");
    });
}

#[test]
fn more_unknown_reads_are_not_noted_again() {
    let this = vk::CommandBuffer::from_raw(9);
    let mesh = Counts::of(30, 1);
    OPEN.with(|open| {
        open.handle.set(9);
        open.forget_bound(9, false);
        open.sets[0].set(77);
        open.is_bound_anew(false);
        assert_eq!(count(this, mesh), Counted::ReadsNotNoted);
        open.noted[1].set(true);
        open.has_unknown[1].set(true);
        open.sets[0].set(78);
        open.is_bound_anew(false);
        assert_eq!(count(this, mesh), Counted::Done, "another set of unknown content");
        assert_eq!(count(this, Counts::of(3, 1)), Counted::ReadsNotNoted, "the first quad");
        open.is_bound_anew(true);
        assert_eq!(count(this, mesh), Counted::ReadsNotNoted, "a set with attachments");
        open.noted[1].set(true);
        open.draws_in(9);
        open.is_bound_anew(false);
        assert_eq!(count(this, mesh), Counted::ReadsNotNoted, "another pass");
    });
}

#[test]
fn counts_that_are_lost_are_not_told() {
    let mut reads = <[Reads; 2]>::default();
    reads[1].push(ImageKey(5));
    let mut tally = Tally { counts: Counts::of(3, 1), ..Tally::default() };
    tally.execute(&Tally { counts: Counts::of(30, 1), reads, ..Tally::default() });
    let draws = tally.finish().unwrap();
    assert_eq!((draws.quads, draws.meshes, draws.vertices), (1, 1, 33));
    assert_eq!(draws.read_by_meshes.images.as_slice(), [ImageKey(5)]);
    assert_eq!(tally.finish(), Some(Draws::default()), "of the next pass");
    tally.execute(&Tally { is_lost: true, ..Tally::default() });
    assert_eq!(tally.finish(), None);
}
