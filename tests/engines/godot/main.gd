extends Node3D
## Runs the scene in OpenXR and prints the cost of its frames.
##
## Arguments behind `--`: `msaa=0|2|4`, `head=still|moving`, `scene=full|light|flat`, `warm=N` and `settle=S` (frames and seconds before the measurement), `frames=N` (of a
## round), `rounds=N`. Where it cannot go on, it prints the reason and quits; `run.sh` ends it after an error of the script.
## Each round prints what a frame of it cost, and the CPU time of the process at its start and end, in milliseconds. Everything moves by the
## number of the frame, counted anew from the first round: two runs show the same pictures.

const Room = preload("res://room.gd")
const MSAA := {"0": Viewport.MSAA_DISABLED, "2": Viewport.MSAA_2X, "4": Viewport.MSAA_4X}

var arguments := {"msaa": "0", "head": "still", "scene": "full", "warm": "30", "settle": "0", "frames": "10", "rounds": "2"}
var frame := 0
var rounds := -1
var room: Node3D
var origin: XROrigin3D
var camera: XRCamera3D
var began_ms := 0.0


func _ready() -> void:
	for argument in OS.get_cmdline_user_args():
		var parts := argument.split("=")
		if parts.size() != 2 or not parts[0] in arguments:
			return fail("unknown argument `%s`; known are %s" % [argument, arguments.keys()])
		arguments[parts[0]] = parts[1]
	if not arguments.msaa in MSAA or not arguments.head in ["still", "moving"]:
		return fail("msaa is 0, 2 or 4, and head is still or moving, not %s" % arguments)
	if not arguments.scene in ["full", "light", "flat"]:
		return fail("scene is full, light or flat, not %s" % arguments.scene)
	var xr := XRServer.find_interface("OpenXR")
	if xr == null or not xr.is_initialized():
		return fail("no OpenXR")
	xr.session_stopping.connect(func() -> void: fail("the session ends"))
	xr.instance_exiting.connect(func() -> void: fail("the runtime ends"))
	var viewport := get_viewport()
	viewport.use_xr = true
	viewport.msaa_3d = MSAA[arguments.msaa]
	origin = XROrigin3D.new()
	camera = XRCamera3D.new()
	origin.add_child(camera)
	add_child(origin)
	room = Room.new(arguments.scene)
	add_child(room)


func _process(_delta: float) -> void:
	if room == null:
		return
	# The simulated head moves by itself; held still, or moved by the frame's number, pictures of two runs are the same.
	var turned := 0.4 * sin(frame * 0.2) if arguments.head == "moving" else 0.0
	origin.transform = Transform3D(Basis(Vector3.UP, turned), Vector3(0, 1.6, 4)) * camera.transform.affine_inverse()
	room.move(frame)
	save_picture()
	frame += 1
	if rounds < 0:
		if frame >= int(arguments.warm) and Time.get_ticks_msec() >= 1000 * int(arguments.settle):
			begin_round()
	elif frame == int(arguments.frames) * (rounds + 1):
		var now := cpu_ms()
		print("engine round: %.2f %.0f %.0f" % [(now - began_ms) / int(arguments.frames), began_ms, now])
		begin_round()
		if rounds >= int(arguments.rounds):
			room = null
			get_tree().quit()


## Has the frames of the first round saved, where a layer of tests waits for their numbers (`parafovea_test_layers::CAPTURE_FOLDER_VARIABLE`).
func save_picture() -> void:
	var folder := OS.get_environment("PARAFOVEA_TEST_CAPTURE_FOLDER")
	if rounds == 0 and folder != "":
		FileAccess.open(folder.path_join("next"), FileAccess.WRITE).store_string(str(frame))


## Says why it cannot go on, and quits.
func fail(reason: String) -> void:
	printerr("engine failed: ", reason)
	room = null
	get_tree().quit(1)


func begin_round() -> void:
	if rounds < 0:
		frame = 0
	rounds += 1
	began_ms = cpu_ms()


## CPU time of all threads of this process, in milliseconds: user and system time of proc(5), in hundredths of a second.
func cpu_ms() -> float:
	var file := FileAccess.open("/proc/self/stat", FileAccess.READ)
	var fields := file.get_line().get_slice(")", 1).split(" ", false)
	return (float(fields[11]) + float(fields[12])) * 10
