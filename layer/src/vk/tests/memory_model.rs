//! The creation of devices with the Vulkan memory model.

use super::fake::{self, rates};
use super::*;

type Model<'a> = vk::PhysicalDeviceVulkanMemoryModelFeatures<'a>;
type Vulkan12<'a> = vk::PhysicalDeviceVulkan12Features<'a>;

/// The memory model and its device scope, as a device enables them with this chain of the application's.
fn enabled(chain: *const c_void) -> [u32; 2] {
    let instance = new_instance(Some(vk::API_VERSION_1_2));
    let device = create_device(instance, fake::device_chain(chain, true).0, 1).unwrap();
    let enabled = rates::memory_model();
    destroy_device(device);
    destroy_instance(instance);
    enabled
}

#[test]
fn an_applications_memory_model_gets_the_scope_of_our_shaders() {
    let model = Model::default().vulkan_memory_model(true);
    let vulkan12 = Vulkan12::default().vulkan_memory_model(true);
    let none = Model::default();
    let chains: [*const c_void; 2] = [(&raw const model).cast(), (&raw const vulkan12).cast()];
    for offered in [true, false] {
        rates::scope(offered);
        for rate_attachments in [true, false] {
            rates::capabilities(rate_attachments, false);
            for chain in chains {
                assert_eq!(enabled(chain), [1, u32::from(offered)]);
                assert_eq!(enabled(unknown(1_000_000_000, chain)), [1, u32::from(offered)]);
            }
            assert_eq!(enabled((&raw const none).cast()), [0, 0], "it is not the application's");
        }
    }
    rates::capabilities(false, false);
    rates::scope(false);
    assert_eq!((model.vulkan_memory_model_device_scope, vulkan12.vulkan_memory_model_device_scope), (0, 0));
}
