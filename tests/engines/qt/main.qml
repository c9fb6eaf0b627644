// Runs the scene in OpenXR and prints the cost of its frames.
//
// Arguments behind `--`: `msaa=0|2|4`, `head=still|moving`, `effects=off|on` (with them, bright lights glow, and passes map tones behind that
// of the scene), `warm=N` and `settle=S` (frames and seconds before the measurement), `frames=N` (of a round), `rounds=N` (0 until the session
// ends), `pictures=FOLDER` (for saved frames). Where it cannot go on, it prints the reason and quits. Its lines are those of `godot/main.gd`.

import QtQuick
import QtQuick3D
import QtQuick3D.Helpers
import QtQuick3D.Xr

XrView {
    id: view

    readonly property var qualities: ({ "2": SceneEnvironment.Medium, "4": SceneEnvironment.High })
    property var settings: ({ msaa: "4", head: "still", effects: "off", warm: "30", settle: "0", frames: "10", rounds: "2", pictures: "" })
    readonly property int antialiasing: settings.msaa === "0" ? SceneEnvironment.NoAA : SceneEnvironment.MSAA
    readonly property int quality: qualities[settings.msaa] ?? SceneEnvironment.Medium
    property int frame: 0
    property int round: -1
    property real beganMs: 0
    property bool hasEnded: false

    environment: settings.effects === "on" ? extended : plain
    xrOrigin: XrOrigin {
        id: origin
        camera: XrCamera { id: head }
    }

    readonly property SceneEnvironment plain: SceneEnvironment {
        backgroundMode: SceneEnvironment.Color
        clearColor: "#88a8c8"
        antialiasingMode: view.antialiasing
        antialiasingQuality: view.quality
    }
    readonly property SceneEnvironment extended: ExtendedSceneEnvironment {
        backgroundMode: SceneEnvironment.Color
        clearColor: "#88a8c8"
        antialiasingMode: view.antialiasing
        antialiasingQuality: view.quality
        tonemapMode: SceneEnvironment.TonemapModeFilmic
        glowEnabled: true
    }

    Room { id: room }

    Timer {
        id: settled
        running: true
    }

    FrameAnimation {
        running: !view.hasEnded
        onTriggered: view.show()
    }

    onInitializeFailed: text => fail(text)
    onSessionEnded: Number(settings.rounds) === 0 ? Qt.quit() : fail("the session ends")

    Component.onCompleted: {
        const given = Qt.application.arguments.slice(Qt.application.arguments.indexOf("--") + 1)
        const read = Object.assign({}, settings)
        for (const argument of given) {
            const [name, value] = argument.split("=")
            if (!(name in read))
                return fail("unknown argument `" + argument + "`; known are " + Object.keys(read))
            read[name] = value
        }
        if (read.msaa !== "0" && !(read.msaa in qualities))
            return fail("msaa is 0, 2 or 4, not " + read.msaa)
        settings = read
        settled.interval = 1000 * Number(read.settle)
        settled.restart()
    }

    // The simulated head moves by itself; held still, or moved by the frame's number, pictures of two runs are the same.
    function show() {
        const turned = settings.head === "moving" ? 0.4 * Math.sin(frame * 0.2) * 180 / Math.PI : 0
        const wanted = Quaternion.fromAxisAndAngle(0, 1, 0, turned)
        origin.rotation = wanted.times(head.rotation.inverted())
        origin.position = Qt.vector3d(0, 160, 400).minus(origin.rotation.times(head.position))
        room.frame = frame
        frame += 1
        if (Number(settings.rounds) === 0)
            return
        if (round < 0) {
            if (frame >= Number(settings.warm) && !settled.running)
                beginRound()
        } else if (frame === Number(settings.frames) * (round + 1)) {
            const now = cpuMs()
            const cost = (now - beganMs) / Number(settings.frames)
            console.log("engine round: %1 %2 %3".arg(cost.toFixed(2)).arg(beganMs).arg(now))
            beginRound()
            if (round === Number(settings.rounds)) {
                hasEnded = true
                Qt.quit()
            }
        }
        savePicture()
    }

    // Has the next frame saved, where it is of the first round and a layer of tests waits for its number
    // (`parafovea_test_layers::CAPTURE_FOLDER_VARIABLE`). Requests write files from the loop of events, which has a turn between two frames;
    // ones that wait do not write.
    function savePicture() {
        if (round !== 0 || settings.pictures === "")
            return
        const request = new XMLHttpRequest()
        request.open("PUT", "file://" + settings.pictures + "/next")
        request.send(String(frame))
    }

    // CPU time of all threads of this process, in milliseconds: user and system time of proc(5), in hundredths of a second.
    function cpuMs() {
        const request = new XMLHttpRequest()
        request.open("GET", "file:///proc/self/stat", false)
        request.send()
        const fields = request.responseText.split(")")[1].trim().split(" ")
        return (Number(fields[11]) + Number(fields[12])) * 10
    }

    function beginRound() {
        if (round < 0)
            frame = 0
        round += 1
        beganMs = cpuMs()
    }

    // Prints the reason for which it cannot go on, and quits.
    function fail(reason) {
        console.error("engine failed: " + reason)
        hasEnded = true
        Qt.exit(1)
    }
}
