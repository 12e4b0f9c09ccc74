import { createContext, useContext } from "react";
import { useStore } from "zustand";
import type { Page, Session } from "../session";

export const SessionContext = createContext<Session | null>(null);

export function useSession(): Session {
  const session = useContext(SessionContext);
  if (!session) throw new Error("there is no session");
  return session;
}

export function usePage<T>(select: (page: Page) => T): T {
  return useStore(useSession().store, select);
}
