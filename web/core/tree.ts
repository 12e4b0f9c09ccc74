// Variables as a tree, by slave and by the dots in their names.
import type { VariableInfo } from "../rpc/messages";

export interface Branch {
  /** The dotted path of this branch. */
  readonly path: string;
  readonly label: string;
  readonly branches: readonly Branch[];
  readonly leaves: readonly VariableInfo[];
  /** How many variables are in it, at all depths. */
  readonly size: number;
}

export function variableTree(variables: readonly VariableInfo[]): Branch {
  return branch("", "", variables);
}

function branch(path: string, label: string, variables: readonly VariableInfo[]): Branch {
  const groups = new Map<string, VariableInfo[]>();
  const leaves: VariableInfo[] = [];
  const depth = path ? path.length + 1 : 0;
  for (const variable of variables) {
    const dot = variable.name.indexOf(".", depth);
    if (dot < 0) leaves.push(variable);
    else {
      const key = variable.name.slice(depth, dot);
      groups.set(key, [...(groups.get(key) ?? []), variable]);
    }
  }
  const branches = [...groups].map(([key, inside]) => branch(path ? `${path}.${key}` : key, key, inside));
  return { path, label, branches, leaves, size: variables.length };
}

/** Variables in which every word of the query occurs, in the name, the unit or the description. */
export function search(variables: readonly VariableInfo[], query: string): readonly VariableInfo[] {
  const words = query.toLowerCase().split(/\s+/).filter(Boolean);
  if (words.length === 0) return variables;
  return variables.filter(({ name, shown, about }) => {
    const text = `${name} ${shown} ${about}`.toLowerCase();
    return words.every((word) => text.includes(word));
  });
}
