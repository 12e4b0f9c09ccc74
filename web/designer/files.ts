// What goes out of the page as a file, and comes in from one; each tells how it went.
import { DesignFileError, read } from "../core/design/file";
import { joined, mesh, stl } from "../core/design/mesh";
import { furnished } from "../core/design/standard";
import type { Crane } from "../core/design/types";
import { download } from "./saving";
import { checked, exported, imported, inWords } from "./server";
import type { DesignerStore } from "./store";

/** The page's inputs of files, by their ids. */
export const DESIGN_FILE = "design-file";
export const FRONT_FILE = "front-file";
export const MESH_FILE = "mesh-file";

/** Lets the person choose a file for one of the inputs. */
export function choose(input: string): void {
  document.getElementById(input)?.click();
}

/** Tells what came of it, or why nothing did. */
export async function attempt(designer: DesignerStore, what: () => Promise<string> | string): Promise<void> {
  try {
    designer.tell(await what());
  } catch (error) {
    designer.tell((error as Error).message, "wrong");
  }
}

export function openDesign(designer: DesignerStore, file: File): Promise<void> {
  return attempt(designer, async () => {
    try {
      designer.open(/\.zip$/i.test(file.name) ? await imported(file) : read(await file.text()));
    } catch (error) {
      if (!(error instanceof DesignFileError)) throw error;
      throw new Error(`${file.name} is not opened. ${error.message}`);
    }
    return `Opened ${file.name}.`;
  });
}

export async function saveArchive(crane: Crane): Promise<string> {
  download(`${crane.name}.zip`, await exported(crane), "application/zip");
  return `Exported ${crane.name}.zip.`;
}

export function saveMeshes(crane: Crane): string {
  for (const link of furnished(crane).links)
    download(`${crane.name}-${link.name}.stl`, stl(joined((link.parts ?? []).map(mesh))) as BlobPart, "model/stl");
  return "One STL file for each link, in metres, z up.";
}

export async function judge(crane: Crane): Promise<string> {
  const problems = await checked(crane);
  if (problems.length) throw new Error(problems.map(inWords).join("\n"));
  return `${crane.name} is sound: the package finds nothing wrong.`;
}
