use super::*;

fn set(number: u64) -> vk::DescriptorSet {
    vk::DescriptorSet::from_raw(number)
}

fn pool(number: u64) -> vk::DescriptorPool {
    vk::DescriptorPool::from_raw(number)
}

fn read(descriptors: &Descriptors, of: vk::DescriptorSet) -> (Vec<u64>, bool) {
    let mut reads = Reads::default();
    descriptors.read(of, &mut reads);
    (reads.images.iter().map(|image| image.0).collect(), reads.may_read_more)
}

/// Descriptors with a set of an open layout, and the layout.
fn with_open_set() -> (Descriptors, vk::DescriptorSetLayout) {
    let (descriptors, layout) = (Descriptors::default(), vk::DescriptorSetLayout::from_raw(1));
    descriptors.add_layout(layout, true);
    descriptors.add_sets(pool(1), &[set(1)], &[layout]);
    (descriptors, layout)
}

#[test]
fn a_set_holds_what_was_written_last() {
    let descriptors = Descriptors::default();
    descriptors.write(set(1), (0, 0), None);
    assert!(!descriptors.may_read(set(1)), "it has no attachment");
    descriptors.write(set(1), (0, 0), Some(ImageKey(7)));
    descriptors.write(set(1), (3, 1), Some(ImageKey(8)));
    assert_eq!(read(&descriptors, set(1)), (vec![7, 8], false));
    descriptors.write(set(1), (0, 0), None);
    assert_eq!(read(&descriptors, set(1)), (vec![8], false));
    descriptors.write(set(1), (3, 1), Some(ImageKey(9)));
    assert_eq!(read(&descriptors, set(1)), (vec![9], false));
    // Another set of the same handle.
    descriptors.add_sets(pool(1), &[set(1)], &[vk::DescriptorSetLayout::null()]);
    assert_eq!(read(&descriptors, set(1)), (vec![], false));
}

#[test]
fn sets_of_open_layouts_may_hold_anything() {
    let (descriptors, layout) = with_open_set();
    assert!(descriptors.may_read(set(1)));
    assert_eq!(read(&descriptors, set(1)), (vec![], true));
    descriptors.write(set(1), (0, 5), Some(ImageKey(7)));
    assert_eq!(read(&descriptors, set(1)), (vec![7], true));
    descriptors.add_layout(layout, false);
    descriptors.add_sets(pool(1), &[set(1)], &[layout]);
    assert_eq!(read(&descriptors, set(1)), (vec![], false));
}

/// Engines without a set for each draw keep all textures in one, the attachments of all passes among them: no draw reads all of them.
#[test]
fn a_set_of_all_textures_names_none() {
    let (descriptors, layout) = with_open_set();
    let write = |element: u32| {
        descriptors.write(set(1), (0, element), Some(ImageKey(element.into())));
    };
    (0..Reads::MOST as u32).for_each(write);
    assert_eq!(read(&descriptors, set(1)).0.len(), Reads::MOST);
    write(100);
    assert_eq!(read(&descriptors, set(1)), (vec![], true));
    assert!(!descriptors.may_name(set(1)));
    descriptors.write(set(1), (0, 100), None);
    (0..3).for_each(write);
    assert_eq!(read(&descriptors, set(1)), (vec![], true));
    descriptors.add_sets(pool(1), &[set(1)], &[layout]);
    write(5);
    assert_eq!(read(&descriptors, set(1)), (vec![5], true), "another set of this handle");
}

#[test]
fn sets_go_with_their_pool() {
    const OF_A_POOL: u64 = 1000;
    let descriptors = Descriptors::default();
    let layout = vk::DescriptorSetLayout::from_raw(1);
    descriptors.add_layout(layout, true);
    let add = |number: u64, first: u64| {
        let sets: Vec<_> = (first..first + OF_A_POOL).map(|number| set(number * 64)).collect();
        let layouts = vec![layout; sets.len()];
        descriptors.add_sets(pool(number), &sets, &layouts);
    };
    add(1, 1);
    descriptors.write(set(64), (0, 0), Some(ImageKey(7)));
    for round in 1..4 * (MOST_SETS as u64 / OF_A_POOL) {
        add(2, round * 2 * OF_A_POOL);
        descriptors.clear_pool(pool(2));
    }
    assert!(descriptors.kept.load(Ordering::Relaxed) <= MOST_SETS + 1);
    assert_eq!(read(&descriptors, set(64)), (vec![7], true), "of the pool that lives");
    assert!(!descriptors.is_overrun());
    assert_eq!(descriptors.sets.all().len(), descriptors.kept.load(Ordering::Relaxed));
}

#[test]
fn ever_more_live_sets_are_unknown() {
    let descriptors = Descriptors::default();
    let open_layout = vk::DescriptorSetLayout::from_raw(1);
    descriptors.add_layout(open_layout, true);
    let mut numbers = 1..;
    let mut write_more = |layout| {
        for number in numbers.by_ref().take(MOST_SETS + 2) {
            descriptors.add_sets(pool(1), &[set(number * 64)], &[layout]);
            descriptors.write(set(number * 64), (0, 0), Some(ImageKey(7)));
            descriptors.open(set(number * 64));
        }
        assert!(descriptors.may_read(set(1)) && read(&descriptors, set(1)).1);
        (descriptors.sweeps.load(Ordering::Relaxed), descriptors.sets.all().len())
    };
    let (sweeps, kept) = write_more(vk::DescriptorSetLayout::null());
    assert_eq!((sweeps, kept), (1, 0));
    for layout in [vk::DescriptorSetLayout::null(), open_layout, open_layout] {
        assert_eq!(write_more(layout), (sweeps, kept), "nothing is kept or swept any more");
    }
    assert!(descriptors.pools.all().is_empty());
}

#[test]
fn freed_sets_are_forgotten() {
    let descriptors = Descriptors::default();
    for _ in 0..3 * Allocated::LEAST {
        descriptors.add_sets(pool(1), &[set(1)], &[vk::DescriptorSetLayout::null()]);
        descriptors.write(set(1), (0, 0), Some(ImageKey(7)));
        assert!(descriptors.may_read(set(1)) && descriptors.may_name(set(1)));
        descriptors.free_sets(pool(1), &[set(1)]);
    }
    assert!(!descriptors.may_read(set(1)) && !descriptors.may_name(set(1)));
    // A layer below may give each set another handle.
    for number in 2..3 * Allocated::LEAST as u64 {
        descriptors.add_sets(pool(1), &[set(number)], &[vk::DescriptorSetLayout::null()]);
        descriptors.free_sets(pool(1), &[set(number)]);
    }
    descriptors.add_sets(pool(1), &[set(1)], &[vk::DescriptorSetLayout::null()]);
    let of_pool = descriptors.pools.get(pool(1)).unwrap();
    let mut of_pool = of_pool.lock().unwrap();
    assert!(of_pool.sets.len() <= Allocated::LEAST, "{} handles of one set", of_pool.sets.len());
    of_pool.leave_out_freed();
    assert_eq!(of_pool.sets, [set(1)], "it was made again");
}

#[test]
fn long_arrays_and_late_writes_are_open() {
    let binding =
        vk::DescriptorSetLayoutBinding::default().descriptor_type(vk::DescriptorType::COMBINED_IMAGE_SAMPLER);
    let of = |count: u32, flags| {
        let bindings = [binding.descriptor_count(count)];
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings).flags(flags);
        // SAFETY: a valid structure.
        unsafe { is_open(&info) }
    };
    let none = vk::DescriptorSetLayoutCreateFlags::empty();
    assert!(!of(16, none) && of(LONG, none));
    assert!(of(1, vk::DescriptorSetLayoutCreateFlags::UPDATE_AFTER_BIND_POOL));
}
