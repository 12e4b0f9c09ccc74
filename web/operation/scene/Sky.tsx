import { useThree } from "@react-three/fiber";
import { useEffect } from "react";
import {
  BackSide,
  Color,
  CubeCamera,
  FogExp2,
  HalfFloatType,
  LinearMipmapLinearFilter,
  Mesh,
  PMREMGenerator,
  Scene,
  ShaderMaterial,
  SphereGeometry,
  type Vector3,
  WebGLCubeRenderTarget,
} from "three";
import { SOFTWARE } from "../../core/software";

export const HORIZON = new Color("#aebfca");

const vertexShader = /* glsl */ `
  varying vec3 ray;
  void main() {
    ray = position;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }`;

// A North Sea day: pale horizon, blue above, layered cloud with gaps, light around the sun.
const fragmentShader = /* glsl */ `
  varying vec3 ray;
  uniform vec3 sun;
  uniform vec3 horizon;
  float hash(vec2 p) { return fract(sin(dot(p, vec2(127.1, 311.7))) * 43758.5453); }
  float noise(vec2 p) {
    vec2 i = floor(p), f = fract(p);
    f = f * f * (3.0 - 2.0 * f);
    return mix(mix(hash(i), hash(i + vec2(1, 0)), f.x), mix(hash(i + vec2(0, 1)), hash(i + vec2(1, 1)), f.x), f.y);
  }
  float cloud(vec2 p) {
    float sum = 0.0, a = 0.5;
    for (int i = 0; i < 5; i++) { sum += a * noise(p); p = p * 2.03 + 7.1; a *= 0.5; }
    return sum;
  }
  void main() {
    vec3 d = normalize(ray);
    float up = max(d.z, 0.0);
    vec3 blue = mix(vec3(0.24, 0.42, 0.62), vec3(0.09, 0.21, 0.43), smoothstep(0.1, 0.8, up));
    vec3 color = mix(horizon, blue, smoothstep(0.0, 0.32, up));
    vec2 p = d.xy / (up + 0.14);
    float c = smoothstep(0.42, 0.78, cloud(p * vec2(1.1, 1.7)));
    float lit = cloud(p * vec2(1.1, 1.7) + sun.xy * 0.25);
    color = mix(color, mix(vec3(0.86, 0.89, 0.92), vec3(0.50, 0.56, 0.62), lit), c * 0.8 * smoothstep(0.015, 0.2, up));
    float s = max(dot(d, sun), 0.0);
    color += vec3(1.0, 0.9, 0.72) * (0.22 * pow(s, 8.0) + 1.6 * pow(s, 180.0));
    if (d.z < 0.0) color = mix(horizon, vec3(0.05, 0.11, 0.15), smoothstep(0.0, -0.15, d.z));
    gl_FragColor = vec4(color, 1.0);
  }`;

/** Draws the sky once into a cube: background, reflections and fog are then of one piece and cost nothing a frame. */
export function Sky({ sun }: { sun: Vector3 }) {
  const { gl, scene } = useThree();
  useEffect(() => {
    const target = new WebGLCubeRenderTarget(SOFTWARE ? 128 : 512, {
      type: HalfFloatType,
      generateMipmaps: true,
      minFilter: LinearMipmapLinearFilter,
    });
    const material = new ShaderMaterial({
      vertexShader,
      fragmentShader,
      side: BackSide,
      depthWrite: false,
      uniforms: { sun: { value: sun.clone().normalize() }, horizon: { value: HORIZON } },
    });
    const dome = new Mesh(new SphereGeometry(10, 32, 24), material);
    const inside = new Scene();
    inside.add(dome);
    new CubeCamera(0.1, 100, target).update(gl, inside);
    const generator = new PMREMGenerator(gl);
    const environment = generator.fromCubemap(target.texture);
    scene.background = target.texture;
    scene.environment = environment.texture;
    scene.fog = new FogExp2(HORIZON, 0.00062);
    dome.geometry.dispose();
    material.dispose();
    generator.dispose();
    return () => {
      scene.background = null;
      scene.environment = null;
      scene.fog = null;
      environment.dispose();
      target.dispose();
    };
  }, [gl, scene, sun]);
  return null;
}
