import { type ReactNode, useLayoutEffect, useRef } from "react";
import { type BufferGeometry, type Group, Matrix4, Mesh, type MeshStandardMaterial } from "three";
import { mergeGeometries } from "three/examples/jsm/utils/BufferGeometryUtils.js";

/**
 * Parts that never move against each other, drawn as one mesh for each material: a crane and a ship are built of
 * hundreds of plates, bars and rails, and each would otherwise cost a call to the graphics card every frame, twice.
 */
export function Merged({ children }: { children: ReactNode }) {
  const parts = useRef<Group>(null);
  const whole = useRef<Group>(null);
  useLayoutEffect(() => {
    const [from, to] = [parts.current, whole.current];
    if (!from || !to) return;
    from.updateWorldMatrix(true, true);
    const home = new Matrix4().copy(from.matrixWorld).invert();
    const byMaterial = new Map<MeshStandardMaterial, BufferGeometry[]>();
    from.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      const material = object.material as MeshStandardMaterial;
      const own = object.geometry as BufferGeometry;
      const geometry = own.index ? own.toNonIndexed() : own.clone();
      if (!material.map) geometry.deleteAttribute("uv");
      geometry.applyMatrix4(new Matrix4().multiplyMatrices(home, object.matrixWorld));
      byMaterial.set(material, [...(byMaterial.get(material) ?? []), geometry]);
    });
    const meshes = [...byMaterial].map(([material, geometries]) => {
      const mesh = new Mesh(mergeGeometries(geometries), material);
      mesh.castShadow = !material.transparent;
      mesh.receiveShadow = true;
      for (const geometry of geometries) geometry.dispose();
      return mesh;
    });
    from.visible = false;
    to.add(...meshes);
    return () => {
      from.visible = true;
      to.remove(...meshes);
      for (const mesh of meshes) mesh.geometry.dispose();
    };
  }, []);
  return (
    <group>
      <group ref={whole} />
      <group ref={parts}>{children}</group>
    </group>
  );
}
