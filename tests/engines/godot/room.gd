extends Node3D
## A lit room with a crowd, a mirror, a screen, glass and sparks. Surfaces are dear and few: fragments are most of a frame.
## `light` has one light, and no shadow, mirror or screen; `flat` has surfaces of one colour besides, which cost next to nothing.

const CROWD := 24

var scene: String
var crowd: Array[MeshInstance3D] = []
var sun: DirectionalLight3D
var lamp: OmniLight3D
var mirror: Camera3D
var words: Label


func _init(scene_: String) -> void:
	scene = scene_
	add_sky()
	add_sun()
	add_walls()
	add_crowd()
	add_glass()
	add_sparks()
	if scene == "full":
		add_lamps()
		add_screen()
		add_mirror()


## Moves everything to where it is in a frame.
func move(frame: int) -> void:
	for index in crowd.size():
		crowd[index].rotation.y = frame * 0.01 + index
		crowd[index].position.y = 0.5 + 0.2 * sin(frame * 0.05 + index)
	if scene != "full":
		return
	lamp.position = Vector3(2 * sin(frame * 0.02), 2.5, 2 * cos(frame * 0.02) - 1)
	words.text = "frame %d" % (frame / 10 * 10)


func add_sky() -> void:
	var sky := Sky.new()
	sky.sky_material = ProceduralSkyMaterial.new()
	var environment := Environment.new()
	environment.background_mode = Environment.BG_COLOR if scene == "flat" else Environment.BG_SKY
	environment.sky = sky
	environment.tonemap_mode = Environment.TONE_MAPPER_FILMIC
	var node := WorldEnvironment.new()
	node.environment = environment
	add_child(node)


func add_sun() -> void:
	sun = DirectionalLight3D.new()
	sun.rotation = Vector3(-0.9, 0.6, 0)
	sun.shadow_enabled = scene == "full"
	sun.directional_shadow_mode = DirectionalLight3D.SHADOW_ORTHOGONAL
	sun.directional_shadow_max_distance = 20
	add_child(sun)


func add_lamps() -> void:
	lamp = OmniLight3D.new()
	lamp.omni_range = 8
	lamp.light_color = Color(1, 0.7, 0.4)
	lamp.light_energy = 3
	add_child(lamp)
	for index in 8:
		var spot := SpotLight3D.new()
		spot.position = Vector3(index % 4 * 2 - 3, 4, index / 4 * 3 - 3)
		spot.rotation.x = -PI / 2
		spot.spot_range = 8
		spot.spot_angle = 50
		spot.light_energy = 1
		spot.light_color = Color.from_hsv(index * 0.125, 0.6, 1)
		spot.shadow_enabled = index == 0
		add_child(spot)


## A material of noise: colour, normals and roughness are textures.
func noisy(seed_: int, tint: Color) -> StandardMaterial3D:
	var material := StandardMaterial3D.new()
	material.albedo_color = tint
	if scene == "flat":
		material.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
		return material
	material.albedo_texture = noise(seed_, false)
	material.normal_enabled = true
	material.normal_texture = noise(seed_ + 1, true)
	material.roughness_texture = material.albedo_texture
	material.uv1_scale = Vector3(3, 3, 3)
	material.uv1_triplanar = true
	material.clearcoat_enabled = true
	material.rim_enabled = true
	material.texture_filter = BaseMaterial3D.TEXTURE_FILTER_LINEAR_WITH_MIPMAPS_ANISOTROPIC
	return material


func noise(seed_: int, as_normals: bool) -> ImageTexture:
	var source := FastNoiseLite.new()
	source.seed = seed_
	source.frequency = 0.02
	var image := source.get_seamless_image(256, 256)
	if as_normals:
		image.convert(Image.FORMAT_RGBA8)
		image.bump_map_to_normal_map(8)
	image.generate_mipmaps()
	return ImageTexture.create_from_image(image)


func add_mesh(mesh: Mesh, material: Material, at: Vector3) -> MeshInstance3D:
	var node := MeshInstance3D.new()
	node.mesh = mesh
	node.material_override = material
	node.position = at
	add_child(node)
	return node


func add_walls() -> void:
	var floor_mesh := PlaneMesh.new()
	floor_mesh.size = Vector2(20, 20)
	add_mesh(floor_mesh, noisy(1, Color(0.8, 0.8, 0.7)), Vector3.ZERO)
	var wall := BoxMesh.new()
	wall.size = Vector3(14, 5, 0.2)
	add_mesh(wall, noisy(3, Color(0.7, 0.5, 0.4)), Vector3(0, 2.5, -6))
	for side in [-1, 1]:
		var node := add_mesh(wall, noisy(5, Color(0.4, 0.5, 0.7)), Vector3(side * 6, 2.5, 0))
		node.rotation.y = PI / 2


func add_crowd() -> void:
	var meshes: Array[Mesh] = [SphereMesh.new(), BoxMesh.new(), CapsuleMesh.new()]
	meshes[0].radial_segments = 12
	meshes[0].rings = 6
	meshes[2].radial_segments = 12
	meshes[2].rings = 2
	var materials: Array[Material] = []
	for index in 6:
		materials.append(noisy(10 + index, Color.from_hsv(index / 6.0, 0.4, 1)))
	for index in CROWD:
		var at := Vector3((index % 8) * 1.3 - 4.5, 0.5, -4.5 + (index / 8) * 1.3)
		var node := add_mesh(meshes[index % 3], materials[index % 6], at)
		node.scale = Vector3.ONE * 0.6
		crowd.append(node)


func add_glass() -> void:
	var material := StandardMaterial3D.new()
	material.transparency = BaseMaterial3D.TRANSPARENCY_ALPHA
	if scene == "flat":
		material.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	material.albedo_color = Color(0.5, 0.8, 1, 0.3)
	material.roughness = 0.1
	var pane := QuadMesh.new()
	pane.size = Vector2(1, 2)
	for index in 3:
		add_mesh(pane, material, Vector3(index * 1.5 - 1.5, 1.2, 1.5 - index * 0.4))


func add_sparks() -> void:
	var process := ParticleProcessMaterial.new()
	process.direction = Vector3.UP
	process.initial_velocity_min = 1
	process.initial_velocity_max = 2
	var material := StandardMaterial3D.new()
	material.transparency = BaseMaterial3D.TRANSPARENCY_ALPHA
	material.blend_mode = BaseMaterial3D.BLEND_MODE_ADD
	material.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	material.albedo_color = Color(1, 0.6, 0.2, 0.5)
	material.billboard_mode = BaseMaterial3D.BILLBOARD_PARTICLES
	var quad := QuadMesh.new()
	quad.size = Vector2(0.08, 0.08)
	quad.material = material
	var particles := GPUParticles3D.new()
	particles.process_material = process
	particles.draw_pass_1 = quad
	particles.amount = 100
	particles.use_fixed_seed = true
	particles.position = Vector3(-1.5, 1, 0)
	add_child(particles)


func add_screen() -> void:
	var view := SubViewport.new()
	view.size = Vector2i(256, 128)
	view.render_target_update_mode = SubViewport.UPDATE_ALWAYS
	words = Label.new()
	words.position = Vector2(20, 40)
	view.add_child(words)
	add_child(view)
	add_view(view, Vector2(1.6, 0.8), Vector3(-1.5, 2.2, 0.5))


func add_mirror() -> void:
	var view := SubViewport.new()
	view.size = Vector2i(256, 256)
	view.render_target_update_mode = SubViewport.UPDATE_ALWAYS
	mirror = Camera3D.new()
	mirror.transform = Transform3D(Basis.from_euler(Vector3(-0.2, PI, 0)), Vector3(2, 2, -5))
	view.add_child(mirror)
	add_child(view)
	add_view(view, Vector2(1.5, 1.5), Vector3(2, 2, -5.5))


## A quad that shows what a viewport renders.
func add_view(view: SubViewport, size: Vector2, at: Vector3) -> void:
	var material := StandardMaterial3D.new()
	material.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	material.albedo_texture = view.get_texture()
	var quad := QuadMesh.new()
	quad.size = size
	add_mesh(quad, material, at)
