/** Materials by the names of the style sheet's colours; they follow the theme. */
import { Color, DoubleSide, LineBasicMaterial, MeshBasicMaterial, MeshStandardMaterial } from "three";
import { colour, onTheme } from "../theme";

type Painted = MeshStandardMaterial | MeshBasicMaterial | LineBasicMaterial;
const made = new Map<string, { name: string; material: Painted }>();

onTheme(() => {
  for (const { name, material } of made.values()) material.color = new Color(colour(name));
});

function remember<M extends Painted>(key: string, name: string, make: () => M): M {
  let entry = made.get(key);
  if (!entry) {
    entry = { name, material: make() };
    entry.material.color = new Color(colour(name));
    made.set(key, entry);
  }
  return entry.material as M;
}

/** A body of the robot. */
export function solid(name: string): MeshStandardMaterial {
  return remember(`solid ${name}`, name, () => new MeshStandardMaterial({ roughness: 0.62, metalness: 0.06 }));
}

/** A body that one sees through. */
export function glass(name: string, opacity: number): MeshStandardMaterial {
  return remember(
    `glass ${name} ${opacity}`,
    name,
    () => new MeshStandardMaterial({ roughness: 0.7, transparent: true, opacity, depthWrite: false, side: DoubleSide }),
  );
}

/** A line or arrow that is seen through the robot. */
export function drawn(name: string, opacity = 1): MeshBasicMaterial {
  return remember(
    `drawn ${name} ${opacity}`,
    name,
    () => new MeshBasicMaterial({ transparent: true, opacity, depthTest: false, depthWrite: false, side: DoubleSide }),
  );
}

/** A hair line, seen through the robot. */
export function hair(name: string, opacity = 1): LineBasicMaterial {
  return remember(
    `hair ${name} ${opacity}`,
    name,
    () => new LineBasicMaterial({ transparent: true, opacity, depthTest: false, depthWrite: false }),
  );
}
