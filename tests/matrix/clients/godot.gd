# Runs in Godot's web build: loads the file that the page names, draws it, and tells the page what is in it.
extends Node3D

var root: Node3D
var camera: Camera3D
var frames := -1
var facts := {}


func _ready() -> void:
	var around := Environment.new()
	around.background_mode = Environment.BG_COLOR
	around.background_color = Color(0.5, 0.5, 0.5)
	around.ambient_light_source = Environment.AMBIENT_SOURCE_COLOR
	around.ambient_light_color = Color(1, 1, 1)
	around.ambient_light_energy = 0.6
	var world := WorldEnvironment.new()
	world.environment = around
	add_child(world)
	var sun := DirectionalLight3D.new()
	sun.rotation = Vector3(-0.8, 0.5, 0)
	add_child(sun)
	camera = Camera3D.new()
	camera.projection = Camera3D.PROJECTION_ORTHOGONAL
	add_child(camera)
	JavaScriptBridge.eval("window.version = '%s'; window.isReady = true" % Engine.get_version_info().string, true)


func _process(_delta: float) -> void:
	if frames >= 0:
		frames -= 1
		if frames == 0:
			answer(facts)
		return
	var text = JavaScriptBridge.eval("window.task || ''", true)
	if text == null or text == "":
		return
	JavaScriptBridge.eval("window.task = ''", true)
	load_file(JSON.parse_string(text))


func answer(what: Dictionary) -> void:
	JavaScriptBridge.eval("window.answer = " + JSON.stringify(JSON.stringify(what)), true)


func load_file(task: Dictionary) -> void:
	if root:
		root.queue_free()
		remove_child(root)
		root = null
	var document := GLTFDocument.new()
	var state := GLTFState.new()
	var fault := document.append_from_file(task.file, state)
	if fault != OK:
		answer({"error": error_string(fault)})
		return
	root = document.generate_scene(state)
	if not root:
		answer({"error": "no scene"})
		return
	add_child(root)
	facts = count(root)
	facts["joints"] = 0
	for skeleton in root.find_children("*", "Skeleton3D", true, false):
		facts["joints"] += skeleton.get_bone_count()
	if facts.joints:
		facts["box"] = null
	facts["clips"] = []
	for player in root.find_children("*", "AnimationPlayer", true, false):
		for name in player.get_animation_list():
			var clip: Animation = player.get_animation(name)
			facts["clips"].append([name, clip.length, clip.get_track_count()])
			player.stop()
	facts["nodes"] = []
	for node in root.find_children("*", "Node", true, false):
		facts["nodes"].append(String(node.name))
	facts["bodies"] = len(root.find_children("*", "CollisionShape3D", true, false))
	facts["cameras"] = len(root.find_children("*", "Camera3D", true, false))
	facts["lights"] = len(root.find_children("*", "DirectionalLight3D", true, false))
	for light in root.find_children("*", "Light3D", true, false):
		light.visible = false
	var low := Vector3(task.box[0][0], task.box[0][1], task.box[0][2])
	var high := Vector3(task.box[1][0], task.box[1][1], task.box[1][2])
	var size := high - low
	camera.size = 1.1 * max(size.x, size.y)
	camera.far = 10.0 * size.length()
	camera.position = (low + high) / 2.0 + Vector3(0, 0, 2.0 * size.length())
	camera.current = true
	frames = 4


func count(top: Node) -> Dictionary:
	var told := {"triangles": 0, "morphs": 0, "lines": 0, "second": []}
	var low := Vector3.INF
	var high := -Vector3.INF
	var materials := {}
	var attributes := {}
	for node: MeshInstance3D in top.find_children("*", "MeshInstance3D", true, false):
		var mesh := node.mesh
		told.morphs = max(told.morphs, mesh.get_blend_shape_count())
		for i in mesh.get_surface_count():
			var arrays := mesh.surface_get_arrays(i)
			var indices = arrays[Mesh.ARRAY_INDEX]
			var points: PackedVector3Array = arrays[Mesh.ARRAY_VERTEX]
			if mesh.surface_get_primitive_type(i) == Mesh.PRIMITIVE_LINES:
				told.lines += 1
				continue
			@warning_ignore("integer_division")
			told.triangles += (indices.size() if indices else points.size()) / 3
			var to_world := node.global_transform
			for point in points:
				var at := to_world * point
				low = low.min(at)
				high = high.max(at)
			if arrays[Mesh.ARRAY_COLOR]:
				attributes["COLOR"] = true
			if arrays[Mesh.ARRAY_TEX_UV2]:
				attributes["UV2"] = true
				var pairs := []
				for pair: Vector2 in arrays[Mesh.ARRAY_TEX_UV2]:
					pairs.append([pair.x, pair.y])
				told.second.append({"vertices": points.size(), "pairs": pairs, "corners": indices if indices else range(points.size())})
			if arrays[Mesh.ARRAY_CUSTOM0]:
				attributes["CUSTOM0"] = true
			var material: BaseMaterial3D = mesh.surface_get_material(i)
			if material:
				materials[material.resource_name] = {
					"picture": material.albedo_texture != null,
					"normals": material.normal_texture != null,
					"cut": material.transparency == BaseMaterial3D.TRANSPARENCY_ALPHA_SCISSOR,
					"two": material.cull_mode == BaseMaterial3D.CULL_DISABLED,
				}
	told["box"] = [[low.x, low.y, low.z], [high.x, high.y, high.z]]
	told["materials"] = materials
	told["attributes"] = attributes.keys()
	return told
