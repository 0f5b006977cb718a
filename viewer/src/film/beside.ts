/** The models beside the robot of a recording that plays by itself. */
import { Box3, Group } from "three";
import { Body } from "../beside/body";
import type { Scene } from "../protocol";
import type { Past, Recording } from "../timeline/recording";

type Model = { body: Body; built: Scene | null };

export class Beside {
  readonly group = new Group();
  /** By their sessions. */
  private readonly all = new Map<string, Model>();

  constructor(recording: Recording, changed: () => void) {
    for (const session of recording.beside.keys()) {
      const body = new Body({ changed, problems: () => undefined });
      body.group.visible = false;
      this.all.set(session, { body, built: null });
      this.group.add(body.group);
    }
  }

  /** As they were at this time. */
  show({ recording, time, scene: { beside } }: Past): void {
    for (const [session, model] of this.all) {
      const { body } = model;
      const track = recording.beside.get(session);
      const stands = beside.find((one) => one.session === session);
      const state = track?.stateBefore(time);
      body.group.visible = Boolean(stands && state);
      if (!track || !stands || !state) continue;
      const scene = track.sceneAt(track.columns.indexAt(time));
      if (scene !== model.built) body.build(scene);
      model.built = scene;
      body.stand(stands, stands.transparent);
      body.robot.place(state);
    }
  }

  /** With the models in it. */
  within(box: Box3): Box3 {
    for (const { body: { group } } of this.all.values()) if (group.visible) box.union(new Box3().setFromObject(group));
    return box;
  }
}
