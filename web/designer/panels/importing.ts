// Meshes of other programs as parts: STL (in metres, z up) and glTF (y up, as it always is).
import type { BufferAttribute, BufferGeometry, Mesh as Shape } from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { STLLoader } from "three/examples/jsm/loaders/STLLoader.js";
import { mergeVertices } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import { ofPart } from "../../core/design/mass";
import { joined, type Mesh, stl } from "../../core/design/mesh";
import type { Part } from "../../core/design/types";

const LARGEST = 8 * 2 ** 20;
const CHUNK = 0x8000;

/** The part that a file holds; an `Error` with what is wrong with it. */
export async function imported(file: File, name: string): Promise<Part> {
  if (file.size > LARGEST) throw new Error(`it is larger than ${LARGEST / 2 ** 20} MiB`);
  const content = await file.arrayBuffer();
  const mesh = /\.stl$/i.test(file.name) ? plain(new STLLoader().parse(content)) : await scene(content);
  if (mesh.faces.length === 0) throw new Error("it holds no triangles");
  const part: Part = { kind: "mesh", name, source: file.name, surface: base64(stl(mesh)) };
  if (!(ofPart(part).mass > 0)) throw new Error("its surface encloses nothing: is it closed, and not inside out?");
  return part;
}

async function scene(content: ArrayBuffer): Promise<Mesh> {
  const { scene } = await new GLTFLoader().parseAsync(content, "");
  scene.updateMatrixWorld(true);
  const found: Mesh[] = [];
  scene.traverse((item) => {
    const shape = item as Shape;
    if (shape.isMesh)
      found.push(
        plain(
          shape.geometry
            .clone()
            .applyMatrix4(shape.matrixWorld)
            .rotateX(Math.PI / 2),
        ),
      );
  });
  return joined(found);
}

function plain(geometry: BufferGeometry): Mesh {
  const bare = geometry.clone();
  for (const attribute of Object.keys(bare.attributes)) if (attribute !== "position") bare.deleteAttribute(attribute);
  const merged = mergeVertices(bare, 1e-6);
  const at = merged.getAttribute("position") as BufferAttribute;
  const vertices = new Float64Array(3 * at.count);
  for (let i = 0; i < at.count; i += 1) vertices.set([at.getX(i), at.getY(i), at.getZ(i)], 3 * i);
  return { vertices, faces: Uint32Array.from(merged.getIndex()?.array ?? []) };
}

function base64(content: Uint8Array): string {
  let text = "";
  for (let i = 0; i < content.length; i += CHUNK) text += String.fromCharCode(...content.subarray(i, i + CHUNK));
  return btoa(text);
}
