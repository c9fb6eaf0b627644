// A lit room with a crowd, a screen, glass and sparks, as in `godot/room.gd`. Surfaces are dear and few: fragments are most of a frame.
// Everything moves by the number of the frame.

import QtQml
import QtQuick
import QtQuick3D
import QtQuick3D.Helpers
import QtQuick3D.Xr

Node {
    id: room

    property int frame: 0

    // Width and height of the textures, texels.
    readonly property int side: 256

    component Noise: Texture {
        id: noise
        required property int seed
        property bool isNormal: false

        textureData: ProceduralTextureData {
            width: room.side
            height: room.side
            format: ProceduralTextureData.RGBA8
            textureData: room.noise(noise.seed, noise.isNormal)
        }
        generateMipmaps: true
        mipFilter: Texture.Linear
        scaleU: 3
        scaleV: 3
    }

    component Rough: PrincipledMaterial {
        baseColorMap: grain
        roughnessMap: grain
        normalMap: bumps
        clearcoatAmount: 0.3
        metalness: 0.1
    }

    Noise {
        id: grain
        seed: 1
    }
    Noise {
        id: bumps
        seed: 2
        isNormal: true
    }
    Instantiator {
        id: surfaces
        model: 6
        Rough {
            required property int index
            baseColor: Qt.hsva(index / 6, 0.4, 1, 1)
        }
    }

    DirectionalLight {
        eulerRotation: Qt.vector3d(-50, 35, 0)
        castsShadow: true
        shadowMapQuality: Light.ShadowMapQualityMedium
        brightness: 0.8
    }
    PointLight {
        position: Qt.vector3d(200 * Math.sin(room.frame * 0.02), 250, 200 * Math.cos(room.frame * 0.02) - 100)
        color: "#ffb366"
        brightness: 3
    }
    Repeater3D {
        model: 8
        SpotLight {
            required property int index
            position: Qt.vector3d(index % 4 * 200 - 300, 400, Math.floor(index / 4) * 300 - 300)
            eulerRotation.x: -90
            color: Qt.hsva(index / 8, 0.6, 1, 1)
            brightness: 5
            coneAngle: 50
        }
    }

    // A sky, unlit. A probe of light from it would take half a minute of the CPU ahead of the first frame.
    Model {
        source: "#Sphere"
        scale: Qt.vector3d(60, 60, 60)
        materials: PrincipledMaterial {
            lighting: PrincipledMaterial.NoLighting
            cullMode: PrincipledMaterial.NoCulling
            baseColor: "#88a8c8"
            baseColorMap: grain
        }
    }
    Model {
        source: "#Rectangle"
        eulerRotation.x: -90
        scale: Qt.vector3d(20, 20, 1)
        materials: Rough { baseColor: "#ccccb3" }
    }
    Model {
        source: "#Cube"
        position: Qt.vector3d(0, 250, -600)
        scale: Qt.vector3d(14, 5, 0.2)
        materials: Rough { baseColor: "#b38066" }
    }
    Repeater3D {
        model: [-1, 1]
        Model {
            required property int modelData
            source: "#Cube"
            position: Qt.vector3d(modelData * 600, 250, 0)
            eulerRotation.y: 90
            scale: Qt.vector3d(14, 5, 0.2)
            materials: Rough { baseColor: "#6680b3" }
        }
    }

    Repeater3D {
        model: 24
        Model {
            required property int index
            source: ["#Sphere", "#Cube", "#Cone"][index % 3]
            position: Qt.vector3d((index % 8) * 130 - 450, 50 + 20 * Math.sin(room.frame * 0.05 + index), Math.floor(index / 8) * 130 - 450)
            eulerRotation.y: (room.frame * 0.01 + index) * 180 / Math.PI
            scale: Qt.vector3d(0.6, 0.6, 0.6)
            materials: surfaces.objectAt(index % 6)
        }
    }

    Repeater3D {
        model: 3
        Model {
            required property int index
            source: "#Rectangle"
            position: Qt.vector3d(index * 150 - 150, 120, 150 - index * 40)
            scale: Qt.vector3d(1, 2, 1)
            materials: PrincipledMaterial {
                baseColor: "#80ccff"
                opacity: 0.3
                alphaMode: PrincipledMaterial.Blend
                roughness: 0.1
            }
        }
    }

    // A picture of Qt Quick in the room.
    XrItem {
        position: Qt.vector3d(-230, 260, 50)
        width: 160
        height: 80
        pixelsPerUnit: 2
        contentItem: Rectangle {
            width: 320
            height: 160
            color: "#203040"
            Text {
                anchors.centerIn: parent
                text: "frame " + Math.floor(room.frame / 10) * 10
                color: "white"
                font.pixelSize: 40
            }
        }
    }

    // Noise on a grid of 16 pixels with half as strong noise on each finer one, as colours or as normals; the same for the same seed.
    function noise(seed, isNormal) {
        let state = seed * 2654435761 % 4294967296
        const random = () => {
            state = (Math.imul(state, 1664525) + 1013904223) >>> 0
            return state / 4294967296
        }
        const heights = new Float32Array(side * side)
        for (let cell = 16, strength = 0.5; cell >= 1; cell /= 2, strength /= 2) {
            const columns = side / cell
            const grid = Float32Array.from({ length: columns * columns }, random)
            for (let y = 0; y < side; ++y)
                for (let x = 0; x < side; ++x)
                    heights[y * side + x] += strength * grid[Math.floor(y / cell) * columns + Math.floor(x / cell)]
        }
        const bytes = new Uint8Array(4 * side * side)
        for (let at = 0; at < side * side; ++at) {
            const [east, south] = [at + 1, at + side].map(next => heights[next % (side * side)] - heights[at])
            const texel = isNormal ? [0.5 + east, 0.5 + south, 1, 1] : [heights[at], heights[at], heights[at], 1]
            bytes.set(texel.map(value => 255 * Math.min(Math.max(value, 0), 1)), 4 * at)
        }
        return bytes.buffer
    }
}
